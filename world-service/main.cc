// The program world-service: loads a world and runs it for the agents that join over DDS.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "common/base/stop_signals.h"
#include "common/dds/binding/network_log.h"
#include "common/dds/transport/dds_transport.h"
#include "common/ros/ros_security.h"
#include "common/security/run_keys_folder.h"
#include "common/security/session_keys.h"
#include "common/spatial/scene.h"
#include "world-service/observers/recorder/make_recorders.h"
#include "world-service/observers/ros/ros_world_gateway.h"
#include "world-service/observers/status/reporter.h"
#include "world-service/program/command_line.h"
#include "world-service/program/session_lock.h"

namespace troupe {
namespace {

// "off" or a folder of keys: on the loopback interface with a token in `own_keys`, if the user asks for nothing else.
Result<std::string> SecurityOf(const NetworkSettings& network, RunKeysFolder& own_keys) {
  if (network.security == kSecurityOn) {
    return Error{{}, "--security: found 'on', expected a folder of keys, auto or off: only 'troupe run' makes keys"};
  }
  if (network.security != kSecurityAuto) return network.security;
  if (network.network_interface != kLoopbackInterface) return std::string(kSecurityOff);
  Result<RunKeysFolder> folder = RunKeysFolder::MakeWithToken();
  if (!folder.ok()) return folder.error();
  own_keys = std::move(folder).value();
  return own_keys.path();
}

int Run(const ServiceCommandLine& line, Reporter& reporter) {
  const auto fail = [&reporter](const Error& error) {
    reporter.Failed(error);
    return ExitStatusOf(error);
  };
  const Result<SessionLock> lock = SessionLock::Acquire(line.network.domain, line.network.session);
  if (!lock.ok()) return fail(lock.error());
  Result<LoadedWorld> loaded = LoadWorld(line.file, line.overrides);
  if (!loaded.ok()) return fail(loaded.error());
  for (const Warning& warning : loaded.value().warnings) fmt::print(stderr, "{}\n", warning.ToString());
  line.run.ApplyTo(loaded.value().settings);
  ServiceOptions options = line.service;
  options.settings = loaded.value().settings;
  options.world_file = line.file;
  options.overrides = line.overrides;
  RestrictRequests(line.permissions, loaded.value(), options);
  if (options.settings.ros) {
    const Result<ros::Enclave> enclave = ros::FindEnclave(line.ros.security, ros::kWorldEnclave);
    if (!enclave.ok()) return fail(enclave.error());
    if (!enclave.value().warning.empty()) fmt::print(stderr, "{}\n", enclave.value().warning);
  }
  const auto scene = std::make_shared<const Scene>(loaded.value().world);

  const StopSignals stop;
  RunKeysFolder own_keys;
  const Result<std::string> security = SecurityOf(line.network, own_keys);
  if (!security.ok()) return fail(security.error());
  const bool secured = security.value() != kSecurityOff;
  Result<PublishedKeys> published =
      PublishedKeys::Publish(line.network.domain, line.network.session, secured ? security.value() : std::string());
  if (!published.ok()) return fail(published.error());
  Result<ParticipantKeys> keys = FindKeys(security.value(), line.network.domain, line.network.session, Role::Service());
  if (!keys.ok()) return fail(keys.error());
  DdsOptions dds;
  static_cast<NetworkSettings&>(dds) = line.network;
  dds.keys = std::move(keys).value();
  dds.on_problem = [](const std::string& problem) { fmt::print(stderr, "{}\n", problem); };
  const dds::NetworkLog network_log(dds.on_problem);
  auto [transport, port, participant] = MakeDdsServiceTransport(dds);
  if (line.faults.any()) transport = MakeFaultyTransport(std::move(transport), line.faults);
  std::unique_ptr<ServiceEndpoint> endpoint = transport->MakeServiceEndpoint();

  reporter.Ready(loaded.value(), {port, participant});
  RunObservers observers;
  std::unique_ptr<RunObserver> ros;
  if (options.settings.ros) {
    ros = MakeRosWorldGateway(line.ros, scene);
    observers.push_back(ros.get());
  }
  const auto recorders = MakeRecorders(scene->world(), line.outputs, line.file);
  if (!recorders.ok()) return fail(recorders.error());
  for (const auto& recorder : recorders.value()) observers.push_back(recorder.get());
  observers.push_back(&reporter);
  const Result<RunSummary> summary = RunService(scene, options, std::move(endpoint), observers, stop.requested());
  if (!summary.ok()) return fail(summary.error());
  reporter.Ended(summary.value());
  return summary.value().interrupted ? kExitInterrupted : kExitDone;
}

int Main(int argc, const char* const* argv) {
  const std::variant<ServiceCommandLine, int> parsed = ParseServiceCommandLine(argc, argv);
  if (const int* exit_status = std::get_if<int>(&parsed)) return *exit_status;
  const ServiceCommandLine& line = std::get<ServiceCommandLine>(parsed);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit fails, as on a full disk
  const std::unique_ptr<Reporter> reporter =
      line.report_fd ? MakeLauncherReporter(*line.report_fd) : MakeConsoleReporter();
  try {
    return Run(line, *reporter);
  } catch (const std::exception& exception) {
    const Error error = FailureOf(exception);
    reporter->Failed(error);
    return ExitStatusOf(error);
  }
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  return troupe::Main(argc, argv);
}
