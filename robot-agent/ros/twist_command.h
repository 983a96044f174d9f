// From a ROS Twist to a command of a drive.
#pragma once

#include <optional>

#include "common/model/world_description.h"
#include "common/ros/messages.h"
#include "troupe/controller.h"

namespace troupe {

// None if linear x or y or angular z is not finite. The drive applies its own bounds. A car steers onto the arc of the
// twist; it cannot turn on the spot.
std::optional<Command> CommandFromTwist(const ros::TwistMessage& twist, const DriveDescription& drive);

}  // namespace troupe
