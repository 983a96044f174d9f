// Whether a proposal from the network may enter a step.
#pragma once

#include <string>

#include "common/model/proposal.h"
#include "common/model/world_state.h"

namespace troupe {

// "" if the proposal is for an existing robot, finite, and within the declared bounds of its drive (velocity and, from
// the velocity it has in `state`, acceleration) and of its joints; else what is wrong with it, for an event.
std::string ValidateProposal(const WorldDescription& world, const WorldState& state, const Proposal& proposal);

}  // namespace troupe
