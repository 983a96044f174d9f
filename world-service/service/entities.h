// What there is in a world, for those who edit it.
#pragma once

#include <string>
#include <vector>

#include "common/protocol/messages.h"

namespace troupe {

// All entities that were not removed, in the order of their ids, as they are in `state`.
std::vector<EntityReport> ListEntities(const WorldDescription& world, const WorldState& state);

// "base", or "base0", "base1", ...: the first that no model has.
std::string FreeName(const WorldDescription& world, const std::string& base);

}  // namespace troupe
