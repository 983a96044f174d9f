#include "world-service/program/command_line.h"

#include <CLI/CLI.hpp>

#include "command_line/run_flags.h"
#include "common/base/identity.h"
#include "common/base/thread_pool.h"
#include "ros/flags/ros_flags.h"
#include "world-service/program/fleet_flags.h"
#include "world-service/program/grid_flags.h"

namespace troupe {
namespace {

// A journal, as `troupe run` makes one by default.
void AddJournalFlags(CLI::App& app, ServiceCommandLine& line) {
  OutputFiles& outputs = line.outputs;
  CLI::Option* const journal =
      app.add_option_function<std::string>(
             "--journal", [&outputs](const std::string& file) { outputs.journal = JournalFiles::Of(file); },
             "Write a recording from which another world service can continue the run with --resume; FILE.journal-a "
             "and "
             "FILE.journal-b have its newest ticks")
          ->check(NotEmpty())
          ->type_name("FILE");
  app.add_flag_function(
      "--journal-sync", [&outputs](std::int64_t) { outputs.journal_sync = JournalSync::kYes; },
      "Wait in each tick until the journal is on the disk, so that it survives a loss of power");
  app.add_flag("--resume", line.resume, "Continue the run of the journal, whose world service has died")
      ->needs(journal);
  // The option of a launcher, whose journals have no names.
  app.add_option_function<std::vector<std::string>>(
         "--journal-tail",
         [&outputs](const std::vector<std::string>& files) {
           outputs.journal->tail = {files[0], files[1]};
         },
         "")
      ->expected(2)
      ->needs(journal)
      ->group("");
  app.add_option("--successor", line.successor, "")->group("");
  app.add_flag("--journal-optional", outputs.journal_is_optional, "")->group("");
}

void AddOptions(CLI::App& app, ServiceCommandLine& line, std::string& faults) {
  AddWorldFile(app, line.file)->required(false);
  // After parsing, because FILE is required or not depending on another option.
  app.final_callback([&line] {
    if (line.file.empty() && !line.resume) throw CLI::RequiredError("FILE");
    const Status branch = CheckBranchFlags(line.file, line.branch, line.overrides.controller);
    if (!branch.ok()) throw CLI::ValidationError(branch.error().message);
  });
  AddRunFlags(app, line.run);
  app.add_flag("--watched", line.run.is_watched, "A viewer shows the run: its default speed is that for people");
  AddRobotsPerProcessFlag(app, line.run.robots_per_process);
  AddSeedFlag(app, line.overrides.seed);
  AddRobotFilesFlag(app, line.overrides.robots);
  AddGridFlags(app, line.overrides.grid);
  AddBranchFlags(app, line.branch);
  AddAllowControllersFlag(app, line.permissions.controllers);
  AddAllowFilesFlag(app, line.permissions.files);
  AddPausedFlag(app, line.service.start_paused);
  AddThreadsFlag(app, line.threads, "1: the others are for the agents");
  line.network.session = "troupe";
  AddSessionFlag(app, line.network, "Name of the run, by which agents join (default: " + line.network.session + ")");
  AddProcessNetworkFlags(app, line.network, line.network.network_interface,
                         "on the interface lo a token of the run, else off");
  AddStartTimeoutFlag(app, line.service.start_timeout_seconds);
  AddHashLogFlag(app, line.outputs.hash_log);
  AddPosesFlag(app, line.outputs.poses);
  AddRecordFlags(app, line.outputs.record, line.outputs.keyframe_interval);
  AddJournalFlags(app, line);
  AddTraceFlags(app, line.service.trace);
  app.add_option("--port", line.ports,
                 "UDP port at which agents of other hosts find the service (default: the first "
                 "free one); further ones are those of groups of agents")
      ->check(WholeNumber(1, 65535))
      ->type_name("PORT")
      ->allow_extra_args(false);
  app.add_option("--report-fd", line.report_fd, "File descriptor for reports to a launcher, as JSON lines")
      ->check(WholeNumber(0, 1 << 20))
      ->type_name("N");
  AddRosFlags(app, line.run.ros, line.ros, "ROS 2");
  AddBuildingMapFlag(app, line.ros.world, "ROS 2");
  AddWorldTopicFlags(app, line.ros.world, "ROS 2");
  AddPoseTopicFlags(app, line.ros.pose_topics, "ROS 2");
  AddLockstepFlags(app, line.ros.lockstep, "ROS 2");
  AddFleetFlags(app, line.fleet, "Connect the vehicles to a fleet control through this MQTT broker");
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
  line.service.pool = std::make_shared<ThreadPool>(line.threads.value_or(1));
  line.service.session = line.network.session;
  line.domain = line.network.domain;
  line.service.lease_seconds = line.network.lease();
  line.service.lease_is_limit = line.network.lease_seconds.has_value();
  return line;
}

}  // namespace troupe
