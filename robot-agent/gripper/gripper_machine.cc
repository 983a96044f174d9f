#include "robot-agent/gripper/gripper_machine.h"

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

// m or rad, of positions near 0.
constexpr double kPositionRounding = 1e-12;

// m, of an opening.
constexpr double kOpeningRounding = 1e-9;

bool IsOpen(const JointMotor& finger, const JointState& state) {
  return JointMotor::IsAt(state, finger.joint().position.min);
}

// The opening, m: the sum of both fingers.
double OpeningOf(const Fingers& f) {
  return f.left.joint().position.max - f.left_state.position + f.right.joint().position.max - f.right_state.position;
}

// The position of a finger that is open by `fraction`, m.
double PositionAt(const Interval& range, double fraction) {
  return range.Clamp(range.max - fraction * (range.max - range.min));
}

// From the present opening to that of `fraction`, m; negative: the fingers close.
double WayToOpening(const Fingers& f, double fraction) {
  const Interval& left = f.left.joint().position;
  const Interval& right = f.right.joint().position;
  return fraction * (left.max - left.min + right.max - right.min) - OpeningOf(f);
}

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

void GripperMachine::SetCommand(FingerCommand command) {
  command_ = command;
  opening_.reset();
  commanded_ = true;
}

void GripperMachine::SetOpening(double fraction) {
  command_.reset();
  opening_ = fraction;
  commanded_ = true;
}

void GripperMachine::UpdateBeams(bool is_broken, const GripperState& gripper) {
  if (!autosnatch_) return;
  const FingerCommand own = is_broken ? FingerCommand::kClose : FingerCommand::kOpen;
  if (commanded_ && command_ != own) return;
  commanded_ = false;
  if (own == FingerCommand::kOpen && gripper.clamped) return;
  command_ = own;
}

FingerState GripperMachine::Report(const Fingers& f) const {
  const bool open = IsOpen(f.left, f.left_state) && IsOpen(f.right, f.right_state);
  if (command_ == FingerCommand::kOpen) return open ? FingerState::kOpen : FingerState::kOpening;
  if (command_ == FingerCommand::kStay || (!command_ && !opening_)) {
    return open ? FingerState::kOpen : FingerState::kClosed;
  }
  const bool done = f.gripper.clamped || !(f.left.moving(f.left_state) || f.right.moving(f.right_state));
  if (opening_ && !done && WayToOpening(f, *opening_) > 0.0) return FingerState::kOpening;
  return done ? FingerState::kClosed : FingerState::kClosing;
}

GripperMachine::Velocities GripperMachine::Propose(const Fingers& f, double tick_seconds) const {
  if (opening_) return ProposeOpening(f, *opening_, tick_seconds);
  const bool clamped = command_ == FingerCommand::kClose && f.gripper.clamped;
  if (!command_ || command_ == FingerCommand::kStay || clamped) {
    f.left.MoveAt(0.0);
    f.right.MoveAt(0.0);
  } else if (command_ == FingerCommand::kOpen) {
    f.left.MoveTo(f.left.joint().position.min);
    f.right.MoveTo(f.right.joint().position.min);
  } else {
    // Also while a contact blocks them: they continue when it ends.
    f.left.MoveTo(f.left.joint().position.max);
    f.right.MoveTo(f.right.joint().position.max);
  }
  return {f.left.Velocity(f.left_state, tick_seconds), f.right.Velocity(f.right_state, tick_seconds)};
}

GripperMachine::Velocities GripperMachine::ProposeOpening(const Fingers& f, double fraction,
                                                          double tick_seconds) const {
  const double way = WayToOpening(f, fraction);
  if (f.gripper.clamped && way <= kOpeningRounding) {
    f.left.MoveAt(0.0);
    f.right.MoveAt(0.0);
  } else {
    // Both to the same opening, but neither against the direction of the other: with an object off the middle, one
    // finger would push it while the other releases it.
    const auto target = [&](const JointMotor& finger, const JointState& state) {
      const double place = PositionAt(finger.joint().position, fraction);
      return way > 0.0 ? std::min(place, state.position) : std::max(place, state.position);
    };
    f.left.MoveTo(target(f.left, f.left_state));
    f.right.MoveTo(target(f.right, f.right_state));
  }
  return {f.left.Velocity(f.left_state, tick_seconds), f.right.Velocity(f.right_state, tick_seconds)};
}

}  // namespace troupe
