// The robot_description from which RViz draws a robot: a URDF with a box around each of the robot's blocks. Its frames
// are those on tf (robot_frames.h), its joints those of joint_states.
#pragma once

#include <string>

#include "common/spatial/scene.h"
#include "ros/messages/names.h"

namespace troupe::ros {

// `name`: the robot's in ROS.
std::string MakeRobotDescription(const Scene& scene, RobotId robot, const std::string& name, const FrameNames& names);

}  // namespace troupe::ros
