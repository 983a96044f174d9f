// The check of a recorded state from which stepping is to start.
#pragma once

#include "troupe/result.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// Success if a step may start from the state: CheckState, poses and joints within their bounds, and no cycle of objects
// that support each other.
Status CheckStartState(const WorldDescription& world, const WorldState& state);

}  // namespace troupe
