// The program world-service: loads a world and runs it for the agents that join over DDS.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "common/base/stop_signals.h"
#include "common/dds/dds_transport.h"
#include "common/dds/network_log.h"
#include "common/spatial/scene.h"
#include "world-service/program/command_line.h"
#include "world-service/program/reporter.h"
#include "world-service/program/session_lock.h"
#include "world-service/ros/ros_world_gateway.h"

namespace troupe {
namespace {

int Run(const CommandLine& line, Reporter& reporter) {
  const auto fail = [&reporter](const Error& error, int exit_status) {
    reporter.Failed(error);
    return exit_status;
  };
  const Result<SessionLock> lock = SessionLock::Acquire(line.domain, line.session);
  if (!lock.ok()) return fail(lock.error(), kExitFailed);
  Result<LoadedWorld> loaded = LoadWorld(line.file, line.overrides);
  if (!loaded.ok()) return fail(loaded.error(), kExitBadInput);
  for (const Warning& warning : loaded.value().warnings) fmt::print(stderr, "{}\n", warning.ToString());
  line.ApplyTo(loaded.value().settings);
  ServiceOptions options = line.service;
  options.settings = loaded.value().settings;
  options.world_file = line.file;
  options.overrides = line.overrides;
  if (options.settings.ros) options.make_gateway = MakeRosWorldGateway(line.ros.options);
  const Scene scene(loaded.value().world);

  const StopSignals stop;
  DdsOptions dds;
  dds.domain = line.domain;
  dds.session = line.session;
  dds.network_interface = line.network_interface;
  dds.network = line.network;
  dds.lease_seconds = options.lease_seconds;
  dds.on_problem = [](const std::string& problem) { fmt::print(stderr, "{}\n", problem); };
  const dds::NetworkLog network_log(dds.on_problem);
  std::uint16_t port = 0;
  std::unique_ptr<Transport> transport = MakeDdsServiceTransport(dds, &port);
  if (line.faults.any()) transport = MakeFaultyTransport(std::move(transport), line.faults);
  std::unique_ptr<ServiceEndpoint> endpoint = transport->MakeServiceEndpoint();

  reporter.Ready(loaded.value(), port);
  const Result<RunSummary> summary = RunService(scene, options, std::move(endpoint), reporter, stop.requested());
  if (!summary.ok()) return fail(summary.error(), kExitFailed);
  reporter.Ended(summary.value());
  return summary.value().interrupted ? kExitInterrupted : kExitDone;
}

int Main(int argc, const char* const* argv) {
  const std::variant<CommandLine, int> parsed = ParseCommandLine(argc, argv);
  if (const int* exit_status = std::get_if<int>(&parsed)) return *exit_status;
  const CommandLine& line = std::get<CommandLine>(parsed);
  std::signal(SIGPIPE, SIG_IGN);
  const std::unique_ptr<Reporter> reporter =
      line.report_fd ? MakeLauncherReporter(*line.report_fd) : MakeConsoleReporter();
  try {
    return Run(line, *reporter);
  } catch (const std::exception& exception) {
    reporter->Failed({{}, exception.what()});
    return kExitFailed;
  }
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  return troupe::Main(argc, argv);
}
