// The check of a state that a peer sent.
#pragma once

#include "common/base/result.h"
#include "common/model/world_description.h"
#include "common/model/world_state.h"

namespace troupe {

// Success if the state belongs to the world: as many robots, joints, grippers and objects, finite numbers, known ids.
Status CheckState(const WorldDescription& world, const WorldState& state);

}  // namespace troupe
