// The program ros-participant: the participant in a ROS domain that the robot-agents of a host share, so that tools
// discover one participant in place of one for each agent. Agents send it their samples over a Unix socket.
#include <fmt/format.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "command_line/exit_status.h"
#include "common/base/flood_limiter.h"
#include "common/base/stop_signals.h"
#include "common/base/wake_event.h"
#include "ros/link/socket_name.h"
#include "ros/participant/command_line.h"
#include "ros/participant/participant_server.h"
#include "transport/dds/binding/network_log.h"

namespace troupe {
namespace {

// A connection for each agent is a descriptor.
void AllowManyAgents() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

int Main(int argc, const char* const* argv) {
  const std::variant<ParticipantCommandLine, int> parsed = ParseParticipantCommandLine(argc, argv);
  if (const int* exit_status = std::get_if<int>(&parsed)) return *exit_status;
  std::signal(SIGPIPE, SIG_IGN);
  AllowManyAgents();
  const WakeEvent stop;
  const StopSignals signals([&stop] { stop.Signal(); });
  FloodLimiter reports([](const std::string& text) { fmt::print(stderr, "ros-participant: warning: {}\n", text); });
  const dds::NetworkLog network_log([&reports](const std::string& text) { reports.Add(text); });
  const ros::RosOptions& options = std::get<ParticipantCommandLine>(parsed).ros;
  const Result<int> listening = ros::Listen(options.participant_socket);
  if (!listening.ok()) {
    fmt::print(stderr, "ros-participant: error: {}\n", listening.error().message);
    return ExitStatusOf(listening.error());
  }
  try {
    ros::ParticipantServer(options, listening.value(), stop, [&reports](const std::string& text) {
      reports.Add(text);
    }).Run();
  } catch (const std::exception& exception) {
    fmt::print(stderr, "ros-participant: error: {}\n", exception.what());
    return ExitStatusOf(FailureOf(exception));
  }
  return kExitDone;
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  return troupe::Main(argc, argv);
}
