// Step: the simulation. A pure function from a state and the robots' proposals to the next state and the ordered
// events. Start here to understand Troupe.
//
// Robots act one after another, in an order that is a fixed function of the tick; each sees the new poses of its
// predecessors. A robot releases the object from which its fingers open, moves its base along the exact arc of its
// twist until its first contact, moves its joints one by one, and grips the object on which its fingers close. Its
// payload (the objects that it holds, and the stacks on them and on it) moves and collides with it. Then objects
// without support fall. A motion cut short by a contact ends at the contact; its stall or blocked flag is set and its
// velocity is zero.
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

// REQUIRES: `state` is InitialState (initial_state.h) of the scene, or the result of a step or an edit; it belongs to
// the scene's world; `proposals` are in robot-id order, at most one for each robot, and valid (validate_proposal.h). A
// robot without a proposal stands still.
StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals);

// The same, for one tick after another: `bodies`, an index of the scene, is updated only by the bodies that have moved
// since the last step. It changes nothing in the result.
StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals, BodyIndex& bodies);

}  // namespace troupe
