// Payload: the objects that a part of a robot carries when it moves.
#pragma once

#include <functional>
#include <vector>

#include "world-service/core/step_workspace.h"

namespace troupe {

struct Payload {
  std::vector<ObjectId> held;     // by a gripper on the part, in id order
  std::vector<ObjectId> stacked;  // on the part, or on other objects of the payload, in id order
};

// The payload of the models for which `moves` is true.
Payload FindPayload(const StepWorkspace& workspace, const std::function<bool(ModelId)>& moves);

// Moves `objects` as frame F was moved, from X_WF_before to X_WF_after; heights change by `dz` m exactly.
void MoveObjects(StepWorkspace& workspace, const std::vector<ObjectId>& objects, const Pose& X_WF_before,
                 const Pose& X_WF_after, double dz);

}  // namespace troupe
