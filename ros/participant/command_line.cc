#include "ros/participant/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <string>

#include "command_line/exit_status.h"
#include "command_line/network_flags.h"
#include "command_line/parse_command_line.h"
#include "command_line/ros_flags.h"
#include "common/base/version.h"
#include "common/run/network_settings.h"

namespace troupe {

std::variant<ParticipantCommandLine, int> ParseParticipantCommandLine(int argc, const char* const* argv) {
  ParticipantCommandLine line;
  line.ros = ros::OptionsFromEnvironment();
  NetworkSettings network;
  std::optional<bool> on;
  CLI::App app("The participant in a ROS domain that the robot-agents of a host share", "ros-participant");
  app.add_option("--socket", line.ros.participant_socket, "Name of the Unix socket at which it listens for agents")
      ->required()
      ->type_name("NAME");
  AddSessionFlag(app, network, "Name of the run")->required();
  AddRosFlags(app, on, line.ros, "ROS 2");
  app.set_version_flag("--version", std::string("ros-participant ") + VersionText());
  if (const std::optional<int> exit_status = ParseCommandLine(app, argc, argv)) return *exit_status;
  line.ros.session = network.session;
  if (line.ros.security.strategy != ros::SecurityStrategy::kOff) {
    fmt::print(stderr, "ros-participant: error: with security each process of a run has a participant of its own\n");
    return kExitBadInput;
  }
  return line;
}

}  // namespace troupe
