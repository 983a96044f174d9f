// Room for an entity: the obstacle at its pose, and the height of its lowest point. For edits, which place entities
// where a user wants them; the step itself never puts a body into another one, and does not ask.
//
// Obstacles are static models, moving bodies and, for what moves, the shafts of lifts without their cabins
// (lift_shafts.h), compared piece by piece as convex prisms, exactly and not by bounding
// boxes. Overlaps up to kNoticeableDepth do not count, so that an entity may be put flush against a wall or onto a
// table by rounded numbers. Of several obstacles the one with the lowest id is returned, so that the message does not
// depend on the order of an index.
//
// Cost: an index of all bodies is made for each call, which is meant for edits and not for ticks.
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
