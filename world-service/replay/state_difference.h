// The first difference between two states of one world, for people.
#pragma once

#include <optional>
#include <string>

#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

struct StateDifference {
  std::string model;  // its name; "the world" for what belongs to none
  std::string field;  // "x", "heading", "joint position", ...
  std::string found;
  std::string expected;
};

// In the order of the lists of WorldState. Nothing if the states are equal, bit by bit but for the sign of
// zero. REQUIRES: `found` belongs to the world.
std::optional<StateDifference> FindDifference(const WorldDescription& world, const WorldState& found,
                                              const WorldState& expected);

}  // namespace troupe
