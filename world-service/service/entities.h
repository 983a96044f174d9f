// The entities of a world, for tools that edit it.
#pragma once

#include <string>
#include <vector>

#include "common/protocol/messages.h"

namespace troupe {

// All entities that were not removed, in the order of their ids, with their poses in `state`.
std::vector<EntityReport> ListEntities(const WorldDescription& world, const WorldState& state);

// "base", or "base0", "base1", ...: the first that is free.
std::string FreeName(const WorldDescription& world, const std::string& base);

}  // namespace troupe
