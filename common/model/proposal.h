// Proposal: an agent's request for its robot's next tick. The step decides how much of it is executed.
#pragma once

#include <vector>

#include "common/base/ids.h"
#include "common/geometry/pose.h"
#include "common/model/radio_message.h"

namespace troupe {

struct Proposal {
  RobotId robot;
  Twist twist;  // in R, constant during the tick
  // By the robot's joints, in id order: m/s or rad/s, constant during the tick or until the joint's limit. Empty: none
  // moves. A finger that closes grips the object that both pads touch; a finger that opens releases it.
  std::vector<double> joint_velocities = {};
  std::vector<RadioMessage> messages = {};  // within the limits of the radios (radio_limits.h)
  bool operator==(const Proposal&) const = default;
};

}  // namespace troupe
