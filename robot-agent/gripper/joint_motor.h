// JointMotor: brings one joint to where it was told to go, tick by tick.
#pragma once

#include <optional>

#include "common/model/world_description.h"
#include "common/model/world_state.h"

namespace troupe {

class JointMotor {
 public:
  // The description must outlive the motor. It stands still until it is told otherwise.
  explicit JointMotor(const JointDescription& joint) : joint_(&joint) {}

  const JointDescription& joint() const { return *joint_; }

  // REQUIRES: `position` is within the joint's limits.
  void MoveTo(double position);
  // To the joint's limit, at most as fast as the joint can.
  void MoveAt(double velocity);

  // What to propose for the next tick. The time it takes to get somewhere does not depend on the length of ticks, and
  // what is reached is reached exactly.
  double Velocity(const JointState& state, double tick_seconds);

  // Where the joint is, up to rounding.
  static bool IsAt(const JointState& state, double position);
  // On its way, and not held up by anything.
  bool moving(const JointState& state) const;

 private:
  // From where the joint is; 0 when it is there up to rounding.
  double WayLeft(const JointState& state) const;

  const JointDescription* joint_;
  std::optional<double> target_;  // m or rad
  double speed_ = 0.0;            // m/s or rad/s
  double asked_ = 0.0;            // what was proposed last
};

}  // namespace troupe
