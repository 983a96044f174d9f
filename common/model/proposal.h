// Proposal: what a robot's agent asks for in the next tick. The step decides what of it happens.
#pragma once

#include <vector>

#include "common/base/ids.h"
#include "common/geometry/pose.h"

namespace troupe {

struct Proposal {
  RobotId robot;
  Twist twist;  // in R, held through the tick
  // By the robot's joints, in id order: m/s or rad/s, held through the tick or until the joint's limit. Empty: none
  // moves. A finger that closes takes hold of what both pads touch; a finger that opens lets go.
  std::vector<double> joint_velocities = {};
  bool operator==(const Proposal&) const = default;
};

}  // namespace troupe
