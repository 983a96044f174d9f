// The radio messages of a step.
#pragma once

#include <span>

#include "common/model/proposal.h"
#include "common/model/world_state.h"

namespace troupe {

// Removes the messages that have arrived before the tick of `state`, and adds those of the proposals, sent in that
// tick. REQUIRES: the proposals are valid and in robot-id order.
void Transmit(const WorldDescription& world, std::span<const Proposal> proposals, WorldState& state);

}  // namespace troupe
