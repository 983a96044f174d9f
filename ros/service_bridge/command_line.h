// The command line of the program ros-service-bridge.
#pragma once

#include <variant>

#include "ros/messages/ros_options.h"

namespace troupe {

struct BridgeCommandLine {
  ros::RosOptions ros;
};

// The exit status where the program ends at once.
std::variant<BridgeCommandLine, int> ParseBridgeCommandLine(int argc, const char* const* argv);

}  // namespace troupe
