// The entities of a world, for tools that edit it.
#pragma once

#include <string>
#include <vector>

#include "transport/protocol/messages.h"
#include "world-service/service/membership.h"

namespace troupe {

// All entities that were not removed, in the order of their ids, with their poses in `state`.
std::vector<EntityReport> ListEntities(const WorldDescription& world, const WorldState& state);

// Sets the agents of those that are robots.
void SetAgents(const WorldDescription& world, const Membership& members, std::vector<EntityReport>& entities);

// "base", or "base0", "base1", ...: the first that is free.
std::string FreeName(const WorldDescription& world, const std::string& base);

// Sets the box of each of `entities`, which are of the world. REQUIRES: the state belongs to the world.
void SetBoxes(const WorldDescription& world, const WorldState& state, std::vector<EntityReport>& entities);

}  // namespace troupe
