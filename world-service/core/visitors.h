// Visitors: people who come into the world and leave it again (VisitorDescription). Private to this folder.
//
// A visitor is due when its flow draws it, or at its own time. It enters at the pose of its model as soon as no body or
// wall is there, and until then waits outside, so that an entrance that is blocked delays people and loses none. Its
// last goal is an exit, at which it leaves. One with a recorded track follows that instead: it is where it was
// recorded, or as near as bodies in its way let it be.
//
// Draws are functions of the world's seed, the flow and the tick. All of it is in the state: a run goes on from any
// snapshot.
#pragma once

#include "troupe/ids.h"
#include "troupe/vec2.h"
#include "troupe/world_state.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// Draws the visitors that come in this tick, and lets those enter that are due and have room. Before people decide.
void AdmitVisitors(StepWorkspace& workspace);

// The plan of a visitor with a track, for the tick `plan` is of: its velocity (m/s, W) to the next position, at most
// max_speed. After the end of the track it leaves. REQUIRES: it has a track, and is in the world.
void FollowTrack(const WorldDescription& world, const VisitorDescription& visitor, Tick tick, PersonState& plan);

// Makes a person one that is away.
void LeaveWorld(const WorldDescription& world, PersonId id, PersonState& person);

}  // namespace troupe
