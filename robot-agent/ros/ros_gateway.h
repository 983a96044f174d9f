// The gateway of an agent's robots to ROS 2: one connection to the participant of the host in the ROS domain of the
// run, and one for each domain of a robot's own; a node for each robot. docs/ros2.md lists the topics.
// All robots of an agent and domain share one connection and one message of transforms: tools receive one sample with
// all poses instead of one for each robot. A robot in a domain of its own sees the network as if it were the only
// robot, with /clock and /map of its own.
//
// The gateway is called by the agent's thread between ticks: commands before the tick, states after it. It never waits
// for ROS, except in a run whose ticks wait for nodes (AwaitPublished).
#pragma once

#include "robot-agent/agent/gateway.h"
#include "ros/messages/ros_options.h"

namespace troupe {

MakeGateway MakeRosGateway(const ros::RosOptions& options);

}  // namespace troupe
