// The obstacle at a pose for which an entity is intended.
#pragma once

#include <optional>

#include "common/spatial/scene.h"
#include "troupe/world_state.h"

namespace troupe {

// Of the obstacles that the tree of `root` overlaps by more than rounding, the one with the lowest id; parts of the
// tree itself do not count. REQUIRES: `root` has no parent; the state belongs to the scene's world.
std::optional<ModelId> FindOverlap(const Scene& scene, const WorldState& state, ModelId root);

}  // namespace troupe
