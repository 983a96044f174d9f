// The program robot-agent: joins a run over DDS and simulates one or more of its robots.
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <stop_token>
#include <thread>

#include "command_line/parse_command_line.h"
#include "common/base/identity.h"
#include "common/base/print.h"
#include "common/base/wake_event.h"
#include "robot-agent/program/command_line.h"
#include "robot-agent/ros/ros_gateway.h"
#include "ros/link/host_program.h"
#include "ros/messages/names.h"
#include "ros/messages/ros_options.h"
#include "transport/dds/binding/network_log.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/protocol/message_texts.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

// Each line names its agent, because many agents may share a terminal.
void Report(const AgentCommandLine& line, const std::string& text) {
  const std::vector<std::string>& robots = line.agent.robots;
  const std::string others = robots.size() > 1 ? fmt::format(" and {} more", robots.size() - 1) : "";
  PrintPlain(stderr, "agent of {}{}: {}\n", robots.front(), others, text);
}

// Reports why the program ends; returns its exit status.
int FailedAgent(const AgentCommandLine& line, const Error& error) {
  Report(line, error.ToString());
  return error.code == ErrorCode::kOutputFailed ? kExitOutputFailed : ExitStatusOf(error);
}

// False if `stop` became true meanwhile.
bool Wait(double seconds, const std::atomic<bool>& stop) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!stop && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return !stop;
}

std::unique_ptr<Transport> MakeTransport(const AgentCommandLine& line, const ParticipantKeys& keys,
                                         const std::function<void()>& on_foreign_run) {
  DdsOptions options;
  static_cast<NetworkSettings&>(options) = line.network;
  options.keys = keys;
  options.on_foreign_run = on_foreign_run;
  options.robots = line.agent.robots;
  options.on_problem = [&line](const std::string& problem) { Report(line, "warning: " + problem); };
  std::unique_ptr<Transport> transport = MakeDdsAgentTransport(options);
  if (line.faults.any()) transport = MakeFaultyTransport(std::move(transport), line.faults);
  return transport;
}

Result<ParticipantKeys> FindKeysOf(const AgentCommandLine& line) {
  const NetworkSettings& network = line.network;
  return FindKeys(network.security, network.domain, network.session, Role::Agent(AgentName(line.agent.robots)));
}

// Runs the agent until its end, or until a stop request. One that was started before its run begins again when the run
// has published its keys.
Result<AgentEnd> RunWithKeys(const AgentCommandLine& line, const AgentOptions& options, const std::stop_token& stop) {
  for (;;) {
    Result<ParticipantKeys> keys = FindKeysOf(line);
    if (!keys.ok()) return keys.error();
    std::atomic<bool> again = false;
    std::stop_source end_attempt;
    const std::stop_callback end_all(stop, [&end_attempt] { end_attempt.request_stop(); });
    const auto stop_if_there_are_others = [&] {
      const Result<ParticipantKeys> found = FindKeysOf(line);
      if (!found.ok() || found.value() == keys.value()) return;
      again = true;
      end_attempt.request_stop();
    };
    const std::unique_ptr<Transport> transport = MakeTransport(line, keys.value(), stop_if_there_are_others);
    Result<AgentEnd> end = RunAgent(transport->MakeAgentEndpoint(options.agent), options, end_attempt.get_token());
    if (!again || !end.ok() || end.value() == AgentEnd::kRunOver) return end;
    if (stop.stop_requested()) return end;
  }
}

int Run(const AgentCommandLine& line) {
  std::stop_source stop;
  const StopSignals signals([&stop] { stop.request_stop(); });
  if (!Wait(line.start_delay_seconds, signals.requested())) return kExitInterrupted;
  const dds::NetworkLog network_log([&line](const std::string& text) { Report(line, "warning: " + text); });
  AgentOptions options = line.agent;
  if (options.agent == 0) options.agent = MakeRandomId();
  for (const std::string& library : line.libraries) options.libraries.Add(library);
  options.on_notice = [&line](const std::string& text) { Report(line, text); };
  std::optional<ros::HostProgram> ros_program;
  if (line.ros_on.value_or(false)) {
    const std::string name = "/" + ros::RosName(line.agent.robots.front());
    const Result<ros::Enclave> keys = ros::FindEnclave(line.ros.network.security, name);
    if (!keys.ok()) return FailedAgent(line, keys.error());
    if (!keys.value().warning.empty()) Report(line, keys.value().warning);
    ros::RosOptions ros_options = line.ros;
    if (ros_options.socket.empty()) {
      const Status started = ros::StartForSession(line.network.domain, line.network.session, name, ros_options,
                                                  ros_program, options.on_notice);
      if (!started.ok()) return FailedAgent(line, started.error());
    }
    options.make_gateway = MakeRosGateway(ros_options);
  }
  const Result<AgentEnd> end = RunWithKeys(line, options, stop.get_token());
  if (end.ok()) return end.value() == AgentEnd::kRunOver ? kExitDone : kExitInterrupted;
  return FailedAgent(line, end.error());
}

int Main(int argc, const char* const* argv) {
  const std::variant<AgentCommandLine, int> parsed = ParseAgentCommandLine(argc, argv);
  if (const int* exit_status = std::get_if<int>(&parsed)) return *exit_status;
  const AgentCommandLine& line = std::get<AgentCommandLine>(parsed);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return Run(line);
  } catch (const std::exception& exception) {
    return FailedAgent(line, FailureOf(exception));
  }
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  return troupe::RunProgram(troupe::Main, argc, argv);
}
