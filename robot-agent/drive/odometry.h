// Odometry: a robot's own idea of where it is.
#pragma once

#include "common/geometry/pose.h"
#include "common/model/world_description.h"

namespace troupe {

class Odometry {
 public:
  explicit Odometry(const LocalizationDescription& localization) : localization_(&localization) {}

  // Takes in the robot's true pose after each tick; the first one fixes where odometry starts.
  void Update(const Pose& X_WR);

  // Somebody has put the robot elsewhere, which is no motion that it could read.
  void Carry(const Pose& X_WR) { last_X_WR_ = X_WR; }

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
