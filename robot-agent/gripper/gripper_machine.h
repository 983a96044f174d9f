// GripperMachine: what the two fingers of a gripper do. Its states are open, closing, closed, opening; it derives them
// from the state of the world and the last command, so that an agent that was started again goes on where it was, and
// drops nothing.
#pragma once

#include <optional>

#include "robot-agent/controller/manipulation.h"
#include "robot-agent/gripper/joint_motor.h"

namespace troupe {

// The fingers' motors and the states of the gripper and its fingers.
struct Fingers {
  JointMotor& left;
  JointMotor& right;
  const JointState& left_state;
  const JointState& right_state;
  const GripperState& gripper;
};

class GripperMachine {
 public:
  // With autosnatch the fingers close when a beam is broken, and open when none is and nothing is between the pads.
  explicit GripperMachine(bool autosnatch) : autosnatch_(autosnatch) {}

  bool autosnatch() const { return autosnatch_; }

  // Holds until the next one. With autosnatch, it holds until the beams ask for the same: fingers that were told to
  // open stay open until the object is out of the beams.
  void Take(FingerCommand command);
  // Likewise: open by `fraction` of how far they can be, over 0 and under 1.
  void TakeOpening(double fraction);
  // With autosnatch, call it before the others in each tick.
  void Sense(bool beam_is_broken, const GripperState& gripper);

  FingerState Report(const Fingers& fingers) const;

  struct Velocities {
    double left = 0.0;  // m/s, for the next tick
    double right = 0.0;
  };
  Velocities Propose(const Fingers& fingers, double tick_seconds) const;

 private:
  bool autosnatch_;
  Velocities ProposeOpening(const Fingers& fingers, double fraction, double tick_seconds) const;

  std::optional<FingerCommand> command_;  // nothing, and no opening_: the fingers stay where they are
  std::optional<double> opening_;         // as in TakeOpening; then there is no command_
  bool commanded_ = false;                // both are a controller's, and the beams have not yet come round to them
};

}  // namespace troupe
