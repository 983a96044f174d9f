#include "launcher/commands/run_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "common/base/output_file.h"
#include "launcher/commands/check_controllers.h"
#include "launcher/commands/check_ros_options.h"
#include "launcher/commands/command_failure.h"
#include "launcher/commands/in_process_viewer.h"
#include "launcher/supervise/check_outputs.h"
#include "launcher/supervise/distributed_run.h"
#include "launcher/supervise/in_process_run.h"
#include "launcher/supervise/run_options.h"
#include "launcher/supervise/summary.h"
#include "robot-agent/controller/create_controller.h"
#include "ros/messages/ros_security.h"
#include "world-service/replay/branched_run.h"

namespace troupe {
namespace {

Status WriteSummary(const std::string& path, const RunOutcome& outcome) {
  Result<OutputFile> file = OutputFile::Create(path);
  if (!file.ok()) return file.error();
  file.value().Append(SummaryJson(outcome));
  if (Status failure = file.value().EndLine(); !failure.ok()) return failure;
  return file.value().Close();
}

int RunCommand(RunOptions options) {
  if (const Status status = CompleteRunOptions(options); !status.ok()) return Fail(status.error());
  if (const Status status = CheckOutputs(options); !status.ok()) return Fail(status.error());
  if (const Status status = CheckControllers(options.file, options.load.controller); !status.ok()) {
    return Fail(status.error());
  }
  for (const std::string& text : options.branch.controllers) {
    const Result<ControllerChange> change = ParseControllerChange(text);
    if (!change.ok()) return Fail(change.error());
    const ControllerDescription& controller = change.value().controller;
    if (const Status status = CheckController(controller.name, controller.parameters); !status.ok()) {
      return Fail({{}, "option --controller: " + status.error().message});
    }
  }
  // Cyclone does not keep two identities in one process apart that are in one domain.
  std::string& enclave = options.ros.network.security.enclave;
  if (options.in_process && enclave.empty()) enclave = ros::kWorldEnclave;
  if (const Status status = CheckRosOptions(options); !status.ok()) return Fail(status.error());
  const MakeViewer make_viewer = [&options](Transport& transport) {
    return MakeInProcessViewer(transport, options.network.session);
  };
  const RunEnd end = options.in_process ? RunInProcess(options, make_viewer) : RunDistributed(options);
  if (end.error) fmt::print(stderr, "{}\n", end.error->ToString());
  if (!end.outcome) return end.exit_status;
  fmt::print("{}", SummaryText(*end.outcome));
  std::fflush(stdout);
  if (!options.summary.empty()) {
    if (const Status status = WriteSummary(options.summary, *end.outcome); !status.ok()) return Fail(status.error());
  }
  return end.exit_status;
}

}  // namespace

void AddRunCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("run", "Run a world: a world service, and a process for each robot");
  const auto options = std::make_shared<RunOptions>();
  AddRunOptions(*command, *options);
  command->final_callback([options, &exit_status] { exit_status = RunCommand(*options); });
}

}  // namespace troupe
