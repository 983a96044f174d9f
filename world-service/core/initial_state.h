// The state that a run begins with.
#pragma once

#include "common/model/world_state.h"
#include "common/spatial/scene.h"

namespace troupe {

// Tick 0: everything where the description has it, objects that stand on a support at rest on it. An object in the air
// stays there until a contact.
WorldState InitialState(const Scene& scene);

}  // namespace troupe
