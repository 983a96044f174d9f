// Step: the simulation. A pure function from a state and what the robots ask for to the next state and what happened.
// Start here to understand Troupe.
//
// Robots move one after another, each along the exact arc of its twist until its first contact, in an order that is a
// fixed function of the tick; each sees those before it already moved. A robot cut short by a contact stands where the
// contact is, with its stall flag set and its velocity zero.
#pragma once

#include <span>
#include <vector>

#include "common/model/event.h"
#include "common/model/proposal.h"
#include "common/model/world_state.h"
#include "common/spatial/scene.h"

namespace troupe {

struct StepResult {
  WorldState state;
  std::vector<Event> events;  // in robot-id order
};

// REQUIRES: `state` belongs to the scene's world; `proposals` are in robot-id order, at most one for each robot, and valid
// (validate_proposal.h). A robot without a proposal stands still.
StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals);

}  // namespace troupe
