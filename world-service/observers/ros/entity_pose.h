// Poses of entities in ROS requests.
#pragma once

#include "ros/messages/messages.h"
#include "troupe/pose.h"
#include "troupe/result.h"

namespace troupe {

// X_WE of an entity E. `frame`: "map" or "world", which are one frame; "" means map. Fails on another frame, on a
// number that is not finite, on a quaternion of zeros, and on a pose that is tilted about x or y.
Result<Pose> PoseFromRos(const char* frame, const ros::PoseMessage& pose);

// A twist of a robot in its frame R: the components that a drive has. The error is another component, or a number that
// is not finite.
Result<Twist> TwistFromRos(const ros::TwistMessage& twist);

}  // namespace troupe
