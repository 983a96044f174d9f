// The frames on a robot, on tf below its base and in its URDF. P: a parent frame, F: a frame on it.
// All poses are constant: what moves is a joint's position. A robot of a URDF or an SDF file keeps the frames of its
// links, each as a child of the base or of the joint's frame that moves it. They come from the scene, as the physics
// has them, so that a scan, a transform and the picture of RViz agree to the bit.
#pragma once

#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "ros/messages/names.h"

namespace troupe::ros {

// A frame that a joint moves.
struct MovingFrame {
  JointId joint;
  std::string joint_name;
  std::string parent;
  std::string frame;
  Pose X_PF;  // at joint position 0
};

// A frame that is fixed on a link: of a sensor, or of the robot's own file, which may be tilted: by roll about x, then
// by pitch about y, then by the heading of the pose (rad).
struct FixedFrame {
  std::string parent;
  std::string frame;
  Pose X_PF;
  double roll = 0.0;
  double pitch = 0.0;
};

struct RobotFrames {
  std::vector<std::string> links;   // by link of the robot's body (common/spatial/scene.h): the base, then one by joint
  std::vector<MovingFrame> moving;  // parents first
  std::vector<FixedFrame> fixed;    // those of the robot's file, then of sensors in the order of SensorTopicsOf
};

RobotFrames RobotFramesOf(const Scene& scene, RobotId robot, const FrameNames& names);

// The pose of the frame in its parent with its joint at `position` (m or rad).
Pose X_PF(const MovingFrame& frame, const WorldDescription& world, double position);

// The robot_description from which RViz draws a robot: a URDF with a box around each of the robot's blocks. Its frames
// are those on tf (robot_frames.h), its joints those of joint_states.
// `name`: the robot's in ROS.
std::string MakeRobotDescription(const Scene& scene, RobotId robot, const std::string& name, const FrameNames& names);

}  // namespace troupe::ros
