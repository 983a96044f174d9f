#include "world-service/program/command_line.h"

#include <CLI/CLI.hpp>
#include <string>

#include "common/base/version.h"
#include "common/command_line/network_flags.h"
#include "common/command_line/option_checks.h"
#include "common/command_line/parse_command_line.h"
#include "common/command_line/ros_flags.h"
#include "common/command_line/run_flags.h"
#include "common/command_line/trace_flags.h"

namespace troupe {
namespace {

void AddOptions(CLI::App& app, ServiceCommandLine& line, std::string& faults) {
  AddWorldFile(app, line.file);
  AddRunFlags(app, line.run);
  AddSeedFlag(app, line.overrides.seed);
  AddControllerFlag(app, line.overrides.controller);
  AddAllowControllersFlag(app, line.permissions.controllers);
  AddAllowFilesFlag(app, line.permissions.files);
  AddPausedFlag(app, line.service.start_paused);
  line.network.session = "troupe";
  AddSessionFlag(app, line.network, "Name of the run, by which agents join (default: " + line.network.session + ")");
  AddProcessNetworkFlags(app, line.network, line.network.network_interface,
                         "on the interface lo a token of the run, else off");
  AddStartTimeoutFlag(app, line.service.start_timeout_seconds);
  AddHashLogFlag(app, line.outputs.hash_log);
  AddPosesFlag(app, line.outputs.poses);
  AddRecordFlags(app, line.outputs.record, line.outputs.keyframe_interval);
  AddTraceFlags(app, line.service.trace);
  app.add_option("--report-fd", line.report_fd, "File descriptor for reports to a launcher, as JSON lines")
      ->check(WholeNumber(0, 1 << 20))
      ->type_name("N");
  AddRosFlags(app, line.run.ros, line.ros, "ROS 2");
  AddFaultsFlag(app, faults);
  app.set_version_flag("--version", std::string("world-service ") + VersionText());
}

}  // namespace

std::variant<ServiceCommandLine, int> ParseServiceCommandLine(int argc, const char* const* argv) {
  ServiceCommandLine line;
  std::string faults;
  CLI::App app("Runs a world: waits for the agents of its robots, and computes each tick from their proposals",
               "world-service");
  AddOptions(app, line, faults);
  if (const std::optional<int> exit_status = ParseCommandLine(app, argc, argv)) return *exit_status;
  line.faults = ParseFaults(faults).value();
  line.service.session = line.network.session;
  line.service.lease_seconds = line.network.lease_seconds;
  return line;
}

}  // namespace troupe
