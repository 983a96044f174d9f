// The boxes around the entities of a world.
#pragma once

#include <vector>

#include "transport/protocol/messages.h"

namespace troupe {

// Sets the box of each of `entities`, which are of the world. REQUIRES: the state belongs to the world.
void SetBoxes(const WorldDescription& world, const WorldState& state, std::vector<EntityReport>& entities);

}  // namespace troupe
