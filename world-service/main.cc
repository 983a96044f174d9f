// The program world-service: loads a world and runs it for the agents that join over DDS.
//
// The order of the steps matters. The lock of the session comes first: a second service must not touch the journal of
// the first. Then the world is loaded, which may fail by the user's input, before keys are published and sockets
// opened. Output files and the gateway to ROS come last, once nothing can fail but the run itself.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>

#include "command_line/parse_command_line.h"
#include "common/base/print.h"
#include "common/base/wake_event.h"
#include "ros/link/host_program.h"
#include "ros/messages/ros_options.h"
#include "transport/dds/binding/network_log.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/security/session_keys.h"
#include "world-service/observers/status/reporter.h"
#include "world-service/program/command_line.h"
#include "world-service/program/prepared_run.h"

namespace troupe {
namespace {

// "off" or a folder of keys: on the loopback interface with a token in `own_keys`, if the user asks for nothing else.
Result<std::string> SecurityOf(const NetworkSettings& network, RunKeysFolder& own_keys) {
  if (network.security == kSecurityOn) {
    return Error{{}, "--security: found 'on', expected a folder of keys, auto or off: only 'troupe run' makes keys"};
  }
  if (network.security != kSecurityAuto) return network.security;
  if (network.network_interface != kLoopbackInterface) {
    PrintPlain(stderr,
               "warning: no keys: any program on the network of interface {} can read and control this run; expected "
               "--security with a folder of keys (troupe keys make), or --security off\n",
               network.network_interface);
    return std::string(kSecurityOff);
  }
  Result<RunKeysFolder> folder = RunKeysFolder::MakeWithToken();
  if (!folder.ok()) return folder.error();
  own_keys = std::move(folder).value();
  return own_keys.path();
}

// The number of groups into which the service divides its agents (transport/dds/transport/dds_service_endpoint.h): more
// than one if a launcher has started it, because only a launcher assigns agents to groups, on the loopback interface
// with data sharing and without DDS Security: elsewhere a frame is written once for each group. A service that
// continues a run has at least as many as the one before it, whose ports are given.
std::size_t CountAgentGroups(const ServiceCommandLine& line, const PreparedRun& run, bool secured) {
  // docs/performance-trials.md has the trials. A group costs the service a participant with its threads.
  constexpr std::size_t kAgentsOfGroup = 64;
  constexpr std::size_t kMaxGroups = 32;
  const NetworkSettings& network = line.network;
  const bool is_shared = network.data_sharing && network.network_interface == kLoopbackInterface &&
                         network.network_profile.empty() && !secured;
  if (!is_shared || !line.report_fd) return 1;
  const std::size_t agents = run.world().robots.size() / std::max(1U, run.options.settings.robots_per_process);
  const std::size_t wanted = (agents + kAgentsOfGroup - 1) / kAgentsOfGroup;
  return std::clamp(wanted, std::max(std::size_t{1}, line.ports.size()), std::max(kMaxGroups, line.ports.size()));
}

// Of the network, if agents do not answer.
std::string AdviceOnSilence(const NetworkSettings& network) {
  const std::string profile = NetworkProfileOf(network);
  if (profile == "one-host") return {};
  if (profile == "unicast") return "a firewall between the hosts may drop the frames";
  return "frames travel by multicast in the network profile lan; on a network that does not pass multicast on, "
         "expected "
         "the profile unicast (--network unicast, for the service and all agents)";
}

int Run(ServiceCommandLine line, Reporter& reporter) {
  const auto fail = [&reporter](const Error& error) {
    reporter.Failed(error);
    return ExitStatusOf(error);
  };
  const Result<SessionLock> lock = SessionLock::Acquire(line.network.domain, line.network.session);
  if (!lock.ok()) return fail(lock.error());
  std::optional<ros::HostProgram> ros_program;  // outlives the connection of the run to it
  Result<PreparedRun> prepared = PrepareRun(line);
  if (!prepared.ok()) return fail(prepared.error());
  PreparedRun& run = prepared.value();
  run.options.advice_on_silence = AdviceOnSilence(line.network);
  const ServiceOptions& options = run.options;
  if (options.settings.ros) {
    const Result<ros::Enclave> enclave = ros::FindEnclave(line.ros.network.security, ros::kWorldEnclave);
    if (!enclave.ok()) return fail(enclave.error());
    if (!enclave.value().warning.empty()) PrintPlain(stderr, "{}\n", enclave.value().warning);
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
  dds.session_bytes = SessionBytes(run.world());
  dds.agent_groups = CountAgentGroups(line, run, !dds.keys.enclave.empty());
  dds.on_problem = [](const std::string& problem) { PrintPlain(stderr, "{}\n", problem); };
  const dds::NetworkLog network_log(dds.on_problem);
  auto [transport, participants] = MakeDdsServiceTransport(dds);
  if (line.faults.any()) transport = MakeFaultyTransport(std::move(transport), line.faults);
  std::unique_ptr<ServiceEndpoint> endpoint = transport->MakeServiceEndpoint();

  if (options.settings.ros && line.ros.socket.empty()) {
    const Status started = ros::StartForSession(line.network.domain, line.network.session, ros::kWorldEnclave, line.ros,
                                                ros_program, dds.on_problem);
    if (!started.ok()) return fail(started.error());
  }
  reporter.Ready(run.world(), options.settings, {participants});
  Result<RunObservers> observers = MakeObservers(run, line);
  if (!observers.ok()) return fail(observers.error());
  observers.value().push_back(&reporter);
  const Result<RunSummary> summary =
      RunService(run.scene, options, std::move(endpoint), observers.value(), stop.requested());
  if (!summary.ok()) return fail(summary.error());
  reporter.Ended(summary.value());
  return summary.value().interrupted ? kExitInterrupted : kExitDone;
}

int Main(int argc, const char* const* argv) {
  const std::variant<ServiceCommandLine, int> parsed = ParseServiceCommandLine(argc, argv);
  if (const int* exit_status = std::get_if<int>(&parsed)) return *exit_status;
  const ServiceCommandLine& line = std::get<ServiceCommandLine>(parsed);
  // A launcher that died closes the pipe of reports; the service then ends by its own rules, not by the signal.
  std::signal(SIGPIPE, SIG_IGN);
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
  return troupe::RunProgram(troupe::Main, argc, argv);
}
