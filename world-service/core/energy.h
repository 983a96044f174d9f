// The energy of a step: what models consume, and what they give to those that touch them.
#pragma once

#include "common/spatial/scene.h"
#include "troupe/world_state.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// True for a robot whose drive is fed by an empty store: it executes no proposal.
bool IsOutOfEnergy(const Scene& scene, const WorldState& state, RobotId robot);

// Empties and fills the stores by one tick, after the robots have acted. First each store loses what its models
// consume. Then models with `take_watts` take from models with `give_watts` that touch them, each at its rate at the
// most, in the order of the takers, then of the givers, as far as there is energy and room. Models touch if blocks of
// theirs or of their children are within 1 mm of each other, in footprint and in height; they need not collide. Models
// of one body do not touch each other, nor do static models. A store that becomes empty is an event of its robot.
void ExchangeEnergy(StepWorkspace& workspace);

}  // namespace troupe
