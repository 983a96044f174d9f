// The program robot-agent: joins a run over DDS and simulates one or more of its robots.
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <thread>

#include "common/base/random_id.h"
#include "common/base/stop_signals.h"
#include "common/dds/dds_transport.h"
#include "common/dds/network_log.h"
#include "robot-agent/program/command_line.h"
#include "robot-agent/ros/ros_gateway.h"

namespace troupe {
namespace {

// Many agents may share a terminal, so each line says whose it is.
void Report(const CommandLine& line, const std::string& text) {
  const std::vector<std::string>& robots = line.agent.robots;
  const std::string others = robots.size() > 1 ? fmt::format(" and {} more", robots.size() - 1) : "";
  fmt::print(stderr, "agent of {}{}: {}\n", robots.front(), others, text);
}

// True unless it was told to stop meanwhile.
bool Wait(double seconds, const std::atomic<bool>& stop) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!stop && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return !stop;
}

std::unique_ptr<Transport> MakeTransport(const CommandLine& line) {
  DdsOptions options;
  options.domain = line.domain;
  options.session = line.session;
  options.network_interface = line.network_interface;
  options.network = line.network;
  options.service_address = line.service_address;
  options.lease_seconds = line.lease_seconds;
  options.on_problem = [&line](const std::string& problem) { Report(line, "warning: " + problem); };
  std::unique_ptr<Transport> transport = MakeDdsAgentTransport(options);
  if (line.faults.any()) transport = MakeFaultyTransport(std::move(transport), line.faults);
  return transport;
}

int Run(const CommandLine& line) {
  const StopSignals signals;
  if (!Wait(line.start_delay_seconds, signals.requested())) return kExitInterrupted;
  const dds::NetworkLog network_log([&line](const std::string& text) { Report(line, "warning: " + text); });
  const std::unique_ptr<Transport> transport = MakeTransport(line);
  AgentOptions options = line.agent;
  options.agent = MakeRandomId();
  if (line.ros.on.value_or(false)) options.make_gateway = MakeRosGateway(line.ros.options);
  bool bad_request = false;
  const Result<bool> over =
      RunAgent(transport->MakeAgentEndpoint(options.agent), options, signals.requested(), &bad_request);
  if (over.ok()) return over.value() ? kExitDone : kExitInterrupted;
  Report(line, over.error().ToString());
  return bad_request ? kExitBadInput : kExitFailed;
}

int Main(int argc, const char* const* argv) {
  const std::variant<CommandLine, int> parsed = ParseCommandLine(argc, argv);
  if (const int* exit_status = std::get_if<int>(&parsed)) return *exit_status;
  const CommandLine& line = std::get<CommandLine>(parsed);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return Run(line);
  } catch (const std::exception& exception) {
    Report(line, std::string("error: ") + exception.what());
    return kExitFailed;
  }
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  return troupe::Main(argc, argv);
}
