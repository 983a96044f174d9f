// Finds places for the models of a scenario's spawn rules.
#pragma once

#include <cstdint>
#include <vector>

#include "troupe/result.h"
#include "worldfile/models/loaded_world.h"
#include "worldfile/scenario/scenario_tree.h"

namespace troupe {

// After so many draws for one model the region counts as full.
inline constexpr std::uint64_t kMaxSpawnDraws = 5000;

// The world with a pose for every model of `spawns`, in order: drawn from the rule's region until the model keeps the
// rule's spacing and overlaps nothing that can be hit or seen, neither in the world nor among the models placed before.
// Overlap is that of collisions: in area and in height. The same world, rules and `seed` give the same poses. The error
// counts the models that found room.
Result<LoadedWorld> PlaceSpawns(LoadedWorld loaded, const std::vector<PlannedSpawn>& spawns, std::uint64_t seed,
                                std::uint64_t max_draws = kMaxSpawnDraws);

}  // namespace troupe
