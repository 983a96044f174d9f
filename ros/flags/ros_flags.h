// The options about ROS 2. Each program has the options of the settings that it uses; `troupe run` has all.
// One definition of each option for all programs: the launcher passes them on by name, and its man page must not differ
// from theirs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ros/messages/ros_options.h"

namespace CLI {
class App;
}

namespace troupe {

// The variables must outlive the parsing, as those of the functions below.
void AddRosNetworkFlags(CLI::App& app, ros::RosNetwork& network, ros::EnvironmentFaults& faults,
                        const std::string& group);
// Adds the options of a process with nodes in ROS: --ros, --no-ros, and the options of the network and of names.
// Without
// --ros and --no-ros `on` keeps its value.
void AddRosFlags(CLI::App& app, std::optional<bool>& on, ros::RosOptions& options, const std::string& group);
void AddRobotTopicFlags(CLI::App& app, ros::RobotTopics& robots, const std::string& group);
// Of a run; robots have no map of a building.
void AddBuildingMapFlag(CLI::App& app, ros::WorldTopics& world, const std::string& group);
void AddWorldTopicFlags(CLI::App& app, ros::WorldTopics& world, const std::string& group);
void AddPoseTopicFlags(CLI::App& app, ros::PoseTopics& topics, const std::string& group);
void AddLockstepFlags(CLI::App& app, RosLockstep& lockstep, const std::string& group);

// The arguments that give the same options to a world service and an agent, without --ros.
std::vector<std::string> ServiceRosArguments(const ros::RosOptions& options);
std::vector<std::string> AgentRosArguments(const ros::RosOptions& options);

}  // namespace troupe
