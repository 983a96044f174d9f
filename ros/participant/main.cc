// The program ros-participant: the participants in ROS of a host, with the nodes, topics and services of all processes
// of a run there. They send it their samples over a Unix socket.
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/identity.h"
#include "common/base/print.h"
#include "common/base/text.h"
#include "common/base/wake_event.h"
#include "common/run/run_settings.h"
#include "ros/flags/ros_flags.h"
#if TROUPE_HAS_FAST_DDS
#include "ros/fast_dds/serve_fast_dds.h"
#endif
#include "ros/link/host_program.h"
#include "ros/link/link.h"
#include "ros/participant/participant_server.h"
#include "transport/dds/binding/network_log.h"

namespace troupe {
namespace {

using ros::ParticipantServer;

struct CommandLine {
  NetworkSettings run;
  ros::RosOptions ros = ros::OptionsFromEnvironment();
  std::string socket;
  bool while_used = false;
  bool is_fast_dds_side = false;
};

// The exit status where the program ends at once.
std::optional<int> Parse(int argc, const char* const* argv, CommandLine& line) {
  CLI::App app("The participants in ROS domains that the processes of a run on this host share", "ros-participant");
  AddSessionFlag(app, line.run, "Name of the run");
  app.add_option("--domain", line.run.domain,
                 fmt::format("DDS domain of the simulation, 0 to {} (default: {})", kMaxDomain, line.run.domain))
      ->check(DdsDomain())
      ->type_name("D");
  app.add_option("--socket", line.socket,
                 "Name of the Unix socket at which it listens (default: where the processes of the session connect)")
      ->type_name("NAME");
  app.add_flag("--while-used", line.while_used, "End with the last connection");
  app.add_flag(ros::FastDdsSide::kFlag, line.is_fast_dds_side)->group("");
  AddRosNetworkFlags(app, line.ros.network, line.ros.faults, "ROS 2");
  app.set_version_flag("--version", std::string("ros-participant ") + VersionText());
  app.final_callback([&line] {
    if (line.socket.empty() && line.run.session.empty() && !line.is_fast_dds_side)
      throw CLI::RequiredError("--session");
  });
  if (const std::optional<int> exit_status = ParseCommandLine(app, argc, argv)) return exit_status;
  if (line.socket.empty()) {
    line.socket = ros::SocketOfSession(line.run.domain, line.run.session, line.ros.network.security);
  }
  return std::nullopt;
}

// A connection for each agent is a descriptor.
void AllowManyAgents() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

int Main(int argc, const char* const* argv) {
  CommandLine line;
  if (const std::optional<int> exit_status = Parse(argc, argv, line)) return *exit_status;
  std::signal(SIGPIPE, SIG_IGN);
  AllowManyAgents();
  const WakeEvent stop;
  const StopSignals signals([&stop] { stop.Signal(); });
#if TROUPE_HAS_FAST_DDS
  if (line.is_fast_dds_side) {
    ros::ServeFastDds(line.ros.network, ros::FastDdsSide::kDescriptor, stop);
    return kExitDone;
  }
#endif
  const auto fail = [](const Error& error) {
    PrintPlain(stderr, "ros-participant: error: {}\n", error.message);
    return ExitStatusOf(error);
  };
  const Result<int> listening = ros::Bind(line.socket);
  if (!listening.ok()) {
    if (!line.while_used) return fail(listening.error());
    // If several are started at the same time, all but one come too late. The process tries that one's socket next,
    // which needs a moment to listen.
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return kExitDone;
  }
  FloodLimiter reports([](const std::string& text) { PrintPlain(stderr, "ros-participant: warning: {}\n", text); });
  const dds::NetworkLog network_log([&reports](const std::string& text) { reports.Add(text); });
  const auto serving = line.while_used ? ParticipantServer::Serving::kWhileUsed : ParticipantServer::Serving::kAlways;
  try {
    ParticipantServer(line.ros.network, listening.value(), serving, stop, [&reports](const std::string& text) {
      reports.Add(text);
    }).Run();
  } catch (const std::exception& exception) {
    return fail(FailureOf(exception));
  }
  return kExitDone;
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  return troupe::RunProgram(troupe::Main, argc, argv);
}
