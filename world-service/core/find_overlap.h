// A place that is intended for an entity: the obstacle there, and the height of its lowest point.
#pragma once

#include <optional>

#include "common/spatial/scene.h"
#include "troupe/world_state.h"

namespace troupe {

// The obstacle at a pose for which an entity is intended. The obstacle with the lowest id that the tree of `root`
// overlaps by more than rounding; parts of the tree itself do not count. REQUIRES: `root` has no parent; the state
// belongs to the scene's world.
std::optional<ModelId> FindOverlap(const Scene& scene, const WorldState& state, ModelId root);

// The lowest point of all blocks of the tree of `root`, in m above the ground; the height of its origin without any
// block.
// REQUIRES: `root` has no parent; the state belongs to the scene's world.
double LowestPoint(const Scene& scene, const WorldState& state, ModelId root);

}  // namespace troupe
