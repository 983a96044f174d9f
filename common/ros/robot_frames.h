// The frames on a robot: what tf publishes below its base, and what its URDF has.
#pragma once

#include <string>
#include <vector>

#include "common/ros/names.h"
#include "common/spatial/scene.h"

namespace troupe::ros {

// A frame that a joint moves.
struct MovingFrame {
  JointId joint;
  std::string joint_name;
  std::string parent;
  std::string frame;
  Pose X_PF;  // at joint position 0
};

// A sensor's, mounted on something.
struct FixedFrame {
  std::string parent;
  std::string frame;
  Pose X_PF;
};

struct RobotFrames {
  std::vector<std::string> links;   // by link of the robot's body (common/spatial/scene.h): the base, then one by joint
  std::vector<MovingFrame> moving;  // parents before what they carry
  std::vector<FixedFrame> fixed;    // in the order of SensorTopicsOf
};

RobotFrames RobotFramesOf(const Scene& scene, RobotId robot, const FrameNames& names);

// Where a frame is in its parent while its joint is at `position` (m or rad).
Pose X_PF(const MovingFrame& frame, const WorldDescription& world, double position);

}  // namespace troupe::ros
