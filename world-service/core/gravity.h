// Gravity: objects whose support has gone fall straight to the highest support under their footprint, and rest there.
#pragma once

#include "world-service/core/step_workspace.h"

namespace troupe {

// Finds which of the objects that a file placed stand on something. Call it before anything has moved.
void FindWhatRests(StepWorkspace& workspace);

// Lets objects fall, land and find what they rest on, from the lowest up. Call it when all robots have moved.
void LetObjectsFall(StepWorkspace& workspace);

}  // namespace troupe
