// The gateway of an agent's robots to ROS 2: one connection to the participant of the host in the ROS domain of the
// run, and one for each domain of a robot's own; a node for each robot. docs/ros2.md lists the topics.
#pragma once

#include "robot-agent/agent/gateway.h"
#include "ros/messages/ros_options.h"

namespace troupe {

MakeGateway MakeRosGateway(const ros::RosOptions& options);

}  // namespace troupe
