// The height of an entity's lowest point.
#pragma once

#include "common/spatial/scene.h"
#include "troupe/world_state.h"

namespace troupe {

// Of all blocks of the tree of `root`, in m above the ground; the height of its origin without any block.
// REQUIRES: `root` has no parent; the state belongs to the scene's world.
double LowestPoint(const Scene& scene, const WorldState& state, ModelId root);

}  // namespace troupe
