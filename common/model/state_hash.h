// The state hash: 64 bits that differ when any bit of a state does (up to collisions). Two runs are the same when their
// hashes are the same at every tick.
#pragma once

#include <cstdint>

#include "troupe/world_state.h"

namespace troupe {

std::uint64_t StateHash(const WorldState& state);

}  // namespace troupe
