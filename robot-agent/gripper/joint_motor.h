// JointMotor: moves one joint to its commanded position, tick by tick.
#pragma once

#include <optional>

#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

class JointMotor {
 public:
  // The description must outlive the motor. Without a command the joint does not move.
  explicit JointMotor(const JointDescription& joint) : joint_(&joint) {}

  const JointDescription& joint() const { return *joint_; }

  // Commands a position, m or rad. REQUIRES: it is within the joint's limits.
  void MoveTo(double position);
  // Commands a velocity, m/s or rad/s, up to the joint's limit; bounded by the speed of the joint.
  void MoveAt(double velocity);

  // The velocity (m/s or rad/s) to propose for the next tick. The time of a motion does not depend on the length of
  // ticks, and the joint reaches its target exactly.
  double Velocity(const JointState& state, double tick_seconds);

  // True if the joint is at `position` (m or rad) up to rounding.
  static bool IsAt(const JointState& state, double position);
  // True if the joint has not reached its target and no contact blocks it.
  bool moving(const JointState& state) const;

 private:
  // From the joint's position to its target, m or rad; 0 at the target up to rounding.
  double RemainingWay(const JointState& state) const;

  const JointDescription* joint_;
  std::optional<double> target_;  // m or rad
  double speed_ = 0.0;            // m/s or rad/s
  double proposed_ = 0.0;         // the last proposal, m/s or rad/s
};

}  // namespace troupe
