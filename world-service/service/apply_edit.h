// Applies an edit of a control request to a world and its state: a pure function, so that a recorded edit can be
// applied again.
#pragma once

#include <memory>

#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "world-service/core/edit_world.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// Reset, load, spawn, delete, set pose, set twist, rewind.
bool IsEdit(ControlCommand command);

// `original`: the scene that a reset restores, the newest that was loaded. The error is the reason why the edit
// cannot be applied: an unknown name, an obstacle, bad scopes. REQUIRES: the command is an edit; `edit.world` is null
// or as in AppliedEdit; `state` belongs to `scene`.
Result<EditedWorld> ApplyEdit(const AppliedEdit& edit, const std::shared_ptr<const Scene>& original,
                              const std::shared_ptr<const Scene>& scene, const WorldState& state);

}  // namespace troupe
