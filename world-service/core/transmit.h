// The radio messages of a step.
#pragma once

#include <span>

#include "common/model/proposal.h"
#include "troupe/world_state.h"

namespace troupe {

// Removes the messages that have arrived before the tick of `state`, and adds those of the proposals, sent in that
// tick. `by_robot`: the proposals by robot, null where there is none. REQUIRES: they are valid.
void Transmit(const WorldDescription& world, std::span<const Proposal* const> by_robot, WorldState& state);

}  // namespace troupe
