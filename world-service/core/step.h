// Step: the simulation. A pure function from a state and what the robots ask for to the next state and what happened.
// Start here to understand Troupe.
//
// Robots act one after another, in an order that is a fixed function of the tick; each sees those before it already
// moved. A robot lets go of what its fingers open from, moves its base along the exact arc of its twist until its first
// contact, moves its joints one by one, and takes hold of what its fingers close on. What it holds, and what stands on
// it, goes along and collides with it. Then what has lost its support falls. A motion cut short by a contact ends where
// the contact is; its stall or blocked flag is set and its velocity is zero.
#pragma once

#include <span>
#include <vector>

#include "common/model/event.h"
#include "common/model/proposal.h"
#include "common/model/world_state.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

namespace troupe {

struct StepResult {
  WorldState state;
  std::vector<Event> events;  // of robots in robot-id order, then of objects
};

// REQUIRES: `state` belongs to the scene's world; `proposals` are in robot-id order, at most one for each robot, and
// valid (validate_proposal.h). A robot without a proposal stands still.
StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals);

// The same, for one tick after another: `bodies`, an index of the scene, takes in only what has moved since the last
// step. It changes nothing in the result.
StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals, BodyIndex& bodies);

}  // namespace troupe
