// Validates proposals from the network before they enter a step.
#pragma once

#include "common/model/proposal.h"
#include "troupe/result.h"
#include "troupe/world_state.h"

namespace troupe {

// Success if the proposal is for an existing robot, finite, and within the declared bounds of its drive (velocity and,
// from the velocity that it has in `state`, acceleration) of its joints and of its radios. The error is for an event.
Status ValidateProposal(const WorldDescription& world, const WorldState& state, const Proposal& proposal);

}  // namespace troupe
