// The program world-service: loads a world and runs it for the agents that join over DDS.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>

#include "common/base/stop_signals.h"
#include "ros/link/host_program.h"
#include "ros/messages/robot_in_ros.h"
#include "ros/messages/ros_security.h"
#include "transport/dds/binding/network_log.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/security/run_keys_folder.h"
#include "transport/security/session_keys.h"
#include "world-service/observers/ros/ros_world_gateway.h"
#include "world-service/observers/status/reporter.h"
#include "world-service/program/agent_groups.h"
#include "world-service/program/command_line.h"
#include "world-service/program/prepared_run.h"
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
  Result<PreparedRun> prepared = PrepareRun(line);
  if (!prepared.ok()) return fail(prepared.error());
  PreparedRun& run = prepared.value();
  const ServiceOptions& options = run.options;
  if (options.settings.ros) {
    run.options.check_world = [&line](const WorldDescription& world) {
      return ros::CheckDomains(world, line.ros.network.domain, line.ros.names, line.network.domain);
    };
    const Status domains = options.check_world(run.loaded.world);
    if (!domains.ok()) return fail(domains.error());
    const Result<ros::Enclave> enclave = ros::FindEnclave(line.ros.network.security, ros::kWorldEnclave);
    if (!enclave.ok()) return fail(enclave.error());
    if (!enclave.value().warning.empty()) fmt::print(stderr, "{}\n", enclave.value().warning);
  }

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
  dds.discovery_ports = line.ports;
  dds.agent_groups = CountAgentGroups(line, run.loaded, !dds.keys.enclave.empty());
  dds.on_problem = [](const std::string& problem) { fmt::print(stderr, "{}\n", problem); };
  const dds::NetworkLog network_log(dds.on_problem);
  auto [transport, participants] = MakeDdsServiceTransport(dds);
  if (line.faults.any()) transport = MakeFaultyTransport(std::move(transport), line.faults);
  std::unique_ptr<ServiceEndpoint> endpoint = transport->MakeServiceEndpoint();

  ros::RosOptions ros_options = line.ros;
  std::optional<ros::HostProgram> ros_program;
  if (options.settings.ros && ros_options.socket.empty()) {
    const Status started = ros::StartForSession(line.network.domain, line.network.session, ros::kWorldEnclave,
                                                ros_options, ros_program, dds.on_problem);
    if (!started.ok()) return fail(started.error());
  }
  reporter.Ready(run.loaded, {participants});
  RunObservers observers;
  std::unique_ptr<RunObserver> ros;
  if (options.settings.ros) {
    ros = MakeRosWorldGateway(ros_options, run.scene);
    observers.push_back(ros.get());
  }
  if (const Status failure = MakeRecordersOf(run, line); !failure.ok()) return fail(failure.error());
  for (const auto& recorder : run.recorders.observers) observers.push_back(recorder.get());
  observers.push_back(&reporter);
  const Result<RunSummary> summary = RunService(run.scene, options, std::move(endpoint), observers, stop.requested());
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
