// The state that a run begins with.
#pragma once

#include "common/spatial/scene.h"
#include "troupe/world_state.h"

namespace troupe {

// Tick 0: all models at their poses in the description, objects on a support at rest on it. An object in the air
// stays there until a contact.
WorldState InitialState(const Scene& scene);

}  // namespace troupe
