// WalkAlone: the velocity that a person would have alone in the world, on its way to its goal. The first half of a
// decision; avoidance.h is the second. Private to this folder.
//
// It goes through the stages of a walk: choose a goal, walk along the routes of the level
// (common/spatial/walk_routes.h), ask for the doors on the way and wait beside their leaves, ride lifts to other levels
// (lift_boarding.h), wait at the goal. A follower does the same with the goals of its leader, and both keep together.
//
// The progress through the stages is in PersonState, and nothing else is remembered: a snapshot, a recording or another
// process can continue in the middle of a ride. Called by several threads at the same time, for different persons. The
// first person of its size that walks to a goal waits for the search for ways to it; others look the way up
// (walk_routes.h).
#pragma once

#include "world-service/core/people_view.h"

namespace troupe {

// Chooses goals, asks for doors and lifts, and changes nothing but `person`, a copy of the person's state.
struct AloneWalk {
  Vec2 velocity{0.0, 0.0};  // m/s
  bool is_bound = false;    // it gets on or off a lift, or rides in it: it does not react to robots
  bool leaves = false;      // it is at an exit
};
AloneWalk WalkAlone(const PeopleView& view, PersonId id, PersonState& person);

}  // namespace troupe
