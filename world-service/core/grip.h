// Taking hold and letting go.
#pragma once

#include <optional>

#include "common/spatial/sweep.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// Opens a gripper's hold. Another gripper that has the object between its pads takes it over; otherwise it is free.
void LetGo(StepWorkspace& workspace, GripperId gripper);

// What one finger did in this tick.
struct FingerMotion {
  double velocity = 0.0;           // asked for
  std::optional<Contact> contact;  // that stopped it
};

// Notes what the pads of a gripper have met, and takes hold of an object that both touch.
void TakeHold(StepWorkspace& workspace, GripperId gripper, const FingerMotion& left, const FingerMotion& right);

// Forgets the objects that grippers waited for between their pads and that have been taken away.
void ForgetWhatIsGone(StepWorkspace& workspace);

}  // namespace troupe
