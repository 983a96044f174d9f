// Gravity: objects that have lost their support fall straight to the highest support under their footprint, and rest
// there.
#pragma once

#include "world-service/core/step_workspace.h"

namespace troupe {

// Sets the placed objects that touch a support from above to rest on it. Nothing moves.
void FindSupports(StepWorkspace& workspace);

// Moves falling objects, lands them and finds their supports, from the lowest up. Call it when all robots have moved.
void LetObjectsFall(StepWorkspace& workspace);

}  // namespace troupe
