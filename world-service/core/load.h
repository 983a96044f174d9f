// Load: the objects that go along when part of a robot moves.
#pragma once

#include <functional>
#include <vector>

#include "world-service/core/step_workspace.h"

namespace troupe {

struct Load {
  std::vector<ObjectId> held;     // by a gripper on what moves, in id order
  std::vector<ObjectId> stacked;  // on what moves, or on other objects that go along, in id order

  bool empty() const { return held.empty() && stacked.empty(); }
};

// What goes along when the models for which `moves` is true move.
Load FindLoad(const StepWorkspace& workspace, const std::function<bool(ModelId)>& moves);

// Moves `objects` as frame F was moved, from X_WF_before to X_WF_after; heights change by `dz` exactly.
void Carry(StepWorkspace& workspace, const std::vector<ObjectId>& objects, const Pose& X_WF_before,
           const Pose& X_WF_after, double dz);

}  // namespace troupe
