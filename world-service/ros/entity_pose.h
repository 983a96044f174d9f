// Poses of entities from ROS.
#pragma once

#include "common/base/result.h"
#include "common/geometry/pose.h"
#include "common/ros/messages.h"

namespace troupe {

// The error is a number that is not finite, a quaternion that is none, a pose that is tilted, or another frame than map
// (or world; "" is map).
Result<Pose> PoseFromRos(const char* frame, const ros::PoseMessage& pose);

}  // namespace troupe
