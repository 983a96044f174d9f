// Gripping and releasing objects.
#pragma once

#include <optional>

#include "common/spatial/sweep.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// Ends a gripper's hold. Another gripper that has the object between its pads holds it from then on; otherwise the
// object is free.
void Release(StepWorkspace& workspace, GripperId gripper);

// The motion of one finger in this tick.
struct FingerMotion {
  double velocity = 0.0;           // demanded, m/s
  std::optional<Contact> contact;  // that stopped it
};

// Updates the contacts of a gripper's pads, and grips an object that touches both.
void Grip(StepWorkspace& workspace, GripperId gripper, const FingerMotion& left, const FingerMotion& right);

// Ends the contacts of grippers with objects that other grippers hold and have removed from between their pads.
void DropLostObjects(StepWorkspace& workspace);

}  // namespace troupe
