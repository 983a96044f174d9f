// The command line of the program ros-service-bridge.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "common/ros/ros_options.h"

namespace troupe {

struct BridgeCommandLine {
  ros::RosOptions ros;
  std::vector<std::uint32_t> robot_domains;  // of robots with a ROS domain of their own
};

// The exit status where the program ends at once.
std::variant<BridgeCommandLine, int> ParseBridgeCommandLine(int argc, const char* const* argv);

}  // namespace troupe
