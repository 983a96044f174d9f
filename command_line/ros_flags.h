// The options about ROS 2, the same for all programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ros/messages/ros_options.h"

namespace CLI {
class App;
}

namespace troupe {

// --ros, --no-ros and --ros-...; without --ros and --no-ros `on` keeps its value. The variables must outlive the
// parsing.
void AddRosFlags(CLI::App& app, std::optional<bool>& on, ros::RosOptions& options, const std::string& group);

// The arguments that give another program of Troupe the same options, without --ros.
std::vector<std::string> RosArguments(const ros::RosOptions& options);

}  // namespace troupe
