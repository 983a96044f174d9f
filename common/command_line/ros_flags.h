// The command-line options about ROS 2: the same for every program.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/ros/ros_options.h"

namespace CLI {
class App;
}

namespace troupe {

struct RosFlags {
  std::optional<bool> on;  // --ros or --no-ros; nothing: as the scenario says
  ros::RosOptions options = ros::OptionsFromEnvironment();
};

// The program keeps `flags` until its command line is parsed.
void AddRosFlags(CLI::App& app, RosFlags& flags, const std::string& group);

// The arguments that give another program of Troupe the same options, without --ros.
std::vector<std::string> RosArguments(const ros::RosOptions& options);

}  // namespace troupe
