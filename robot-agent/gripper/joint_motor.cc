#include "robot-agent/gripper/joint_motor.h"

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

// m or rad, of positions near 0.
constexpr double kPositionRounding = 1e-12;

}  // namespace

void JointMotor::MoveTo(double position) {
  target_ = position;
  speed_ = joint_->max_speed;
}

void JointMotor::MoveAt(double velocity) {
  target_.reset();
  if (velocity != 0.0) target_ = velocity > 0.0 ? joint_->position.max : joint_->position.min;
  speed_ = std::min(std::abs(velocity), joint_->max_speed);
}

double JointMotor::Velocity(const JointState& state, double tick_seconds) {
  const bool to_limit = target_ == joint_->position.min || target_ == joint_->position.max;
  // The limits stop a joint exactly.
  const double way = to_limit ? *target_ - state.position : RemainingWay(state);
  if (way == 0.0) {
    proposed_ = 0.0;
  } else if (to_limit || std::abs(way) >= speed_ * tick_seconds) {
    proposed_ = way > 0.0 ? speed_ : -speed_;
  } else {
    proposed_ = way / tick_seconds;
  }
  return proposed_;
}

bool JointMotor::moving(const JointState& state) const {
  const double way = RemainingWay(state);
  const bool is_blocked = state.blocked && proposed_ * way > 0.0;
  return way != 0.0 && speed_ > 0.0 && !is_blocked;
}

double JointMotor::RemainingWay(const JointState& state) const {
  return !target_ || IsAt(state, *target_) ? 0.0 : *target_ - state.position;
}

bool JointMotor::IsAt(const JointState& state, double position) {
  return std::abs(position - state.position) <= kPositionRounding * std::max(1.0, std::abs(position));
}

}  // namespace troupe
