// From a ROS Twist to what a drive is asked for. Pure functions.
#pragma once

#include <optional>

#include "common/model/world_description.h"
#include "common/ros/messages.h"
#include "robot-agent/controller/controller.h"

namespace troupe {

// Nothing if a number that counts (linear x and y, angular z) is not finite. The drive bounds the rest. A car turns its
// wheels so that it takes the curve of the twist, and cannot turn without driving.
std::optional<Command> CommandFromTwist(const ros::TwistMessage& twist, const DriveDescription& drive);

}  // namespace troupe
