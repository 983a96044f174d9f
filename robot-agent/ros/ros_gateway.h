// The gateway of an agent's robots to ROS 2: one participant in the ROS domain for the process, and a node for each
// robot. docs/ros2.md lists the topics.
#pragma once

#include "common/ros/ros_options.h"
#include "robot-agent/agent/gateway.h"

namespace troupe {

MakeGateway MakeRosGateway(const ros::RosOptions& options);

}  // namespace troupe
