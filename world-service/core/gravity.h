// Gravity: objects that have lost their support fall straight to the highest support under their footprint, and rest
// there.
#pragma once

#include "world-service/core/step_workspace.h"

namespace troupe {

// Puts the placed objects that stand on a support to rest on it. Nothing moves.
void FindSupports(StepWorkspace& workspace);

// Lets objects fall, land and find their supports, from the lowest up. Call it when all robots have moved.
void LetObjectsFall(StepWorkspace& workspace);

}  // namespace troupe
