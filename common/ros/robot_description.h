// The robot_description that RViz draws a robot from: URDF, made from the robot's blocks. Each block becomes a box
// around its outline. Frames are those that Troupe publishes on tf (robot_frames.h), joints those of joint_states.
#pragma once

#include <string>

#include "common/ros/names.h"
#include "common/spatial/scene.h"

namespace troupe::ros {

// `name`: the robot's in ROS.
std::string MakeRobotDescription(const Scene& scene, RobotId robot, const std::string& name, const FrameNames& names);

}  // namespace troupe::ros
