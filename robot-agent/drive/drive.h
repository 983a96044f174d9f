// Drives: the twist of a robot from a command, the command from a twist, and the pose estimate of a robot.
//
// A drive turns a wish into a twist that is within its limits, from the present twist in one tick: the result is what
// the agent proposes, and the service checks it by the same function (common/model/device_limits.h). Pure functions,
// but for Odometry, which is a sum over ticks.
//
// A car: speed is that of the steered wheel, so that vx = speed cos(steering), wz = speed sin(steering) / wheelbase.
#pragma once

#include "troupe/controller.h"
#include "troupe/pose.h"
#include "troupe/world_description.h"

namespace troupe {

// The twist (in R) that the drive reaches from its present twist `current` within `seconds` on the way to `command`,
// within its limits. A component of the command that is not finite counts as zero.
Twist DriveTowards(const DriveDescription& drive, const Twist& current, const Command& command, double seconds);

// The command for a twist. The drive applies its own bounds. A car steers onto the arc of the twist; it cannot turn on
// the spot. REQUIRES: IsFinite(wanted).
Command CommandFromTwist(const Twist& wanted, const DriveDescription& drive);

// The pose estimate of a robot.
class Odometry {
 public:
  explicit Odometry(const LocalizationDescription& localization) : localization_(&localization) {}

  // Applies the robot's true pose after a tick; odometry starts at the first one.
  void Update(const Pose& X_WR);

  // Applies a true pose that an edit has set: not a motion, so the estimate stays.
  void Relocate(const Pose& X_WR) { last_X_WR_ = X_WR; }

  // gps: the true pose in the world. odometry: the sum of the robot's motions, each read with its error, from
  // localization.origin on (frame: odom).
  const Pose& estimate() const { return estimate_; }

 private:
  const LocalizationDescription* localization_;
  bool started_ = false;
  Pose last_X_WR_;
  Pose estimate_;
};

}  // namespace troupe
