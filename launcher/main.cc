// The program troupe: runs, checks, observes and draws simulations. docs/running.md is its manual.
#include <CLI/CLI.hpp>

#include "common/base/version.h"
#include "common/command_line/exit_status.h"
#include "common/command_line/parse_command_line.h"
#include "launcher/commands/check_command.h"
#include "launcher/commands/ctl_command.h"
#include "launcher/commands/export_map_command.h"
#include "launcher/commands/host_command.h"
#include "launcher/commands/keys_command.h"
#include "launcher/commands/run_command.h"
#include "launcher/commands/snapshot_command.h"
#include "launcher/commands/top_command.h"

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  CLI::App app("Troupe, a distributed 2.5D multi-robot simulator", "troupe");
  app.set_version_flag("--version", std::string("troupe ") + troupe::VersionText());
  app.require_subcommand(1);
  int exit_status = troupe::kExitDone;
  troupe::AddRunCommand(app, exit_status);
  troupe::AddCheckCommand(app, exit_status);
  troupe::AddTopCommand(app, exit_status);
  troupe::AddCtlCommand(app, exit_status);
  troupe::AddSnapshotCommand(app, exit_status);
  troupe::AddExportMapCommand(app, exit_status);
  troupe::AddKeysCommand(app, exit_status);
  troupe::AddHostCommand(app, exit_status);
  return troupe::ParseCommandLine(app, argc, argv).value_or(exit_status);
}
