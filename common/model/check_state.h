// Whether a state that came from a peer belongs to a world.
#pragma once

#include <string>

#include "common/model/world_description.h"
#include "common/model/world_state.h"

namespace troupe {

// "" if the state has as many robots, joints, grippers and objects as the world, all finite, and names only what the
// world has; else what is wrong with it.
std::string CheckState(const WorldDescription& world, const WorldState& state);

}  // namespace troupe
