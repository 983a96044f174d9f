// Finds places for what a scenario's spawn rules add.
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/result.h"
#include "common/worldfile/load_world.h"
#include "common/worldfile/scenario_tree.h"

namespace troupe {

// After so many draws for one model the region counts as full.
inline constexpr std::uint64_t kMaxSpawnDraws = 5000;

// Gives every model of `spawns` a pose, in order: drawn from the rule's region until it overlaps nothing that can be
// hit or seen, neither what stands in the world nor what was placed before, and keeps the rule's spacing. Overlap is
// that of collisions: in area and in height. The same world, rules and `seed` give the same poses. The error says how
// many found room.
Status PlaceSpawns(const std::vector<PlannedSpawn>& spawns, std::uint64_t seed, LoadedWorld* loaded,
                   std::uint64_t max_draws = kMaxSpawnDraws);

}  // namespace troupe
