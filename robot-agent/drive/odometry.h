// Odometry: the pose estimate of a robot.
#pragma once

#include "troupe/pose.h"
#include "troupe/world_description.h"

namespace troupe {

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
