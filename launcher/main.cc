// troupe: runs, checks, watches and draws simulations. docs/running.md is its manual.
#include <CLI/CLI.hpp>

#include "common/base/version.h"
#include "common/command_line/exit_status.h"
#include "common/command_line/option_checks.h"
#include "common/command_line/parse_command_line.h"
#include "launcher/check_command.h"
#include "launcher/ctl_command.h"
#include "launcher/export_map_command.h"
#include "launcher/host_command.h"
#include "launcher/run_command.h"
#include "launcher/run_options.h"
#include "launcher/snapshot_command.h"
#include "launcher/top_command.h"

namespace {

void AddTopOptions(CLI::App& command, troupe::TopOptions& options) {
  command.add_option("--domain", options.domain, "DDS domain of the simulation (default: 42)")
      ->check(troupe::DdsDomain())
      ->type_name("D");
  command.add_option("--session", options.session, "Show this session only")->type_name("NAME");
  command.add_option("--interface", options.network_interface, "Network interface, or auto (default: lo)")
      ->type_name("NAME");
  command.add_option("--service", options.service_address, "Where a service is that multicast does not reach")
      ->type_name("HOST[:PORT]");
  command.add_flag("--once", options.once, "Print one table and end");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Troupe, a distributed 2.5D multi-robot simulator", "troupe");
  app.set_version_flag("--version", std::string("troupe ") + troupe::VersionText());
  app.require_subcommand(1);
  int exit_status = troupe::kExitDone;

  troupe::RunOptions run_options;
  CLI::App* run = app.add_subcommand("run", "Run a world: a world service and a process for each robot");
  troupe::AddRunOptions(*run, run_options);
  run->final_callback([&] { exit_status = troupe::RunCommand(run_options); });

  std::string checked_file;
  CLI::App* check = app.add_subcommand("check", "Load a world and say what it holds, without running it");
  check->add_option("FILE", checked_file, "A Stage .world file, a JSON scenario or a ROS map .yaml")->required();
  check->final_callback([&] { exit_status = troupe::CheckCommand(checked_file); });

  troupe::TopOptions top_options;
  CLI::App* top = app.add_subcommand("top", "Show the sessions that run, and who keeps them waiting");
  AddTopOptions(*top, top_options);
  top->final_callback([&] { exit_status = troupe::TopCommand(top_options); });

  CLI::App* host = app.add_subcommand("host", "Start processes for a launcher elsewhere, which starts this by itself");
  host->final_callback([&] { exit_status = troupe::HostCommand(); });

  troupe::AddSnapshotCommand(app, exit_status);
  troupe::AddCtlCommand(app, exit_status);
  troupe::AddExportMapCommand(app, exit_status);

  return troupe::ParseCommandLine(app, argc, argv).value_or(exit_status);
}
