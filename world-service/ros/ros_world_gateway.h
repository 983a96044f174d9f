// The gateway of the world to ROS 2: clock, map, markers and events. docs/ros2.md lists the topics.
#pragma once

#include "common/ros/ros_options.h"
#include "world-service/service/world_gateway.h"

namespace troupe {

MakeWorldGateway MakeRosWorldGateway(const ros::RosOptions& options);

}  // namespace troupe
