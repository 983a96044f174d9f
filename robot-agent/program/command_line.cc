#include "robot-agent/program/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>

#include "command_line/run_flags.h"
#include "common/base/identity.h"
#include "ros/flags/ros_flags.h"

namespace troupe {
namespace {

// The option of a launcher, which reports the end of the agent to the world service by this number.
void AddAgentIdFlag(CLI::App& app, AgentCommandLine& line) {
  const auto check = [&line](const std::string& text) -> std::string {
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, line.agent.agent, 16);
    if (parsed.ec == std::errc() && parsed.ptr == end && line.agent.agent != 0) return "";
    return "found '" + text + "', expected a hexadecimal number above 0";
  };
  app.add_option_function<std::string>(
         "--agent-id", [](const std::string&) {}, "")
      ->check(CLI::Validator(check, ""))
      ->group("");
}

void AddOptions(CLI::App& app, AgentCommandLine& line, std::string& faults) {
  AddSessionFlag(app, line.network, "Name of the run to join")->required();
  app.add_option("--robot", line.agent.robots, "Name of a robot to simulate; repeatable")
      ->check(NotEmpty())
      ->type_name("NAME")
      ->required()
      ->allow_extra_args(false);
  AddAgentIdFlag(app, line);
  AddServiceAddressFlag(app, line.network, "Address of the world service (default: this host)");
  app.add_option("--service-participant", line.network.service_participant,
                 "Identity of the world service, as its launcher knows it: any other participant is ignored (default: "
                 "the first one that announces the run)")
      ->check(ParticipantValue())
      ->type_name("HEX");
  line.network.network_interface.clear();  // follows from --service
  AddProcessNetworkFlags(app, line.network, "lo: this host only; auto with --service",
                         "the keys of your own run of this session on this host, if it has any");
  app.add_option("--session-timeout", line.agent.session_timeout_seconds,
                 fmt::format("Seconds to wait for the world service; 0: no limit (default: {})",
                             line.agent.session_timeout_seconds))
      ->check(NumberFromZero())
      ->type_name("SECONDS");
  AddAllowControllersFlag(app, line.libraries);
  AddScansFlag(app, line.agent.scan_log);
  app.add_flag("--keep-scans", line.agent.keep_scan_log,
               "Append to the file of --scans, for a robot whose agent is started again");
  app.add_flag("--skip-unavailable", line.agent.skip_unavailable,
               "Leave out the robots that were deleted or have another agent, for an agent that is started while the "
               "run goes on");
  AddTraceFlags(app, line.agent.trace);
  AddRosFlags(app, line.ros_on, line.ros, "ROS 2");
  AddRobotTopicFlags(app, line.ros.robots, "ROS 2");
  AddWorldTopicFlags(app, line.ros.world, "ROS 2");
  AddFaultsFlag(app, faults);
  app.add_option("--start-delay", line.start_delay_seconds, "Seconds to wait before joining (default: 0)")
      ->check(NumberFromZero())
      ->type_name("SECONDS")
      ->group("Testing");
  app.set_version_flag("--version", std::string("robot-agent ") + VersionText());
}

}  // namespace

std::variant<AgentCommandLine, int> ParseAgentCommandLine(int argc, const char* const* argv) {
  AgentCommandLine line;
  std::string faults;
  CLI::App app("Simulates one or more robots of a run: their sensors, controllers and drives", "robot-agent");
  AddOptions(app, line, faults);
  if (const std::optional<int> exit_status = ParseCommandLine(app, argc, argv)) return *exit_status;
  line.faults = ParseFaults(faults).value();
  NetworkSettings& network = line.network;
  if (network.network_interface.empty()) {
    network.network_interface = network.service_address.empty() ? kLoopbackInterface : kAutomaticInterface;
  }
  return line;
}

}  // namespace troupe
