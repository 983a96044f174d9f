#include "robot-agent/gripper/gripper_machine.h"

namespace troupe {
namespace {

bool IsOpen(const JointMotor& finger, const JointState& state) {
  return JointMotor::IsAt(state, finger.joint().position.min);
}

}  // namespace

void GripperMachine::Take(FingerCommand command) {
  command_ = command;
  commanded_ = true;
}

void GripperMachine::Sense(bool beam_is_broken, const GripperState& gripper) {
  if (!autosnatch_) return;
  const FingerCommand own = beam_is_broken ? FingerCommand::kClose : FingerCommand::kOpen;
  if (commanded_ && command_ != own) return;
  commanded_ = false;
  if (own == FingerCommand::kOpen && gripper.clamped) return;
  command_ = own;
}

FingerState GripperMachine::Report(const Fingers& f) const {
  const bool open = IsOpen(f.left, f.left_state) && IsOpen(f.right, f.right_state);
  if (command_ == FingerCommand::kOpen) return open ? FingerState::kOpen : FingerState::kOpening;
  if (!command_) return open ? FingerState::kOpen : FingerState::kClosed;
  const bool done = f.gripper.clamped || !(f.left.moving(f.left_state) || f.right.moving(f.right_state));
  return done ? FingerState::kClosed : FingerState::kClosing;
}

GripperMachine::Velocities GripperMachine::Propose(const Fingers& f, double tick_seconds) const {
  const bool clamped = command_ == FingerCommand::kClose && f.gripper.clamped;
  if (!command_ || clamped) {
    f.left.MoveAt(0.0);
    f.right.MoveAt(0.0);
  } else if (command_ == FingerCommand::kOpen) {
    f.left.MoveTo(f.left.joint().position.min);
    f.right.MoveTo(f.right.joint().position.min);
  } else {
    // Also while something holds them up: when it goes away, they go on.
    f.left.MoveTo(f.left.joint().position.max);
    f.right.MoveTo(f.right.joint().position.max);
  }
  return {f.left.Velocity(f.left_state, tick_seconds), f.right.Velocity(f.right_state, tick_seconds)};
}

}  // namespace troupe
