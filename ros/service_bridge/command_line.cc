#include "ros/service_bridge/command_line.h"

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

std::variant<BridgeCommandLine, int> ParseBridgeCommandLine(int argc, const char* const* argv) {
  BridgeCommandLine line;
  line.ros = ros::OptionsFromEnvironment();
  NetworkSettings network;
  std::optional<bool> on;
  CLI::App app("Passes calls of ROS services from clients on rmw_fastrtps to a run, and the responses back",
               "ros-service-bridge");
  AddSessionFlag(app, network, "Name of the run")->required();
  AddRosFlags(app, on, line.ros, "ROS 2");
  app.set_version_flag("--version", std::string("ros-service-bridge ") + VersionText());
  if (const std::optional<int> exit_status = ParseCommandLine(app, argc, argv)) return *exit_status;
  line.ros.session = network.session;
  line.ros.service_clients = line.ros.service_clients.value_or(ros::ServiceClients::kBoth);
  if (!ros::UsesBridge(line.ros)) {
    fmt::print(
        stderr,
        "ros-service-bridge: error: a run with security, with --ros-discovery off or with --ros-services cyclone "
        "has no bridge\n");
    return kExitBadInput;
  }
  return line;
}

}  // namespace troupe
