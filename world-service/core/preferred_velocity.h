// The walks of people: the velocity that each would have alone, on its way to its goal. Private to this folder.
#pragma once

#include "world-service/core/people_view.h"

namespace troupe {

// Chooses goals, asks for doors and lifts, and changes nothing but `person`, a copy of the person's state.
struct AloneWalk {
  Vec2 velocity{0.0, 0.0};  // m/s
  bool is_bound = false;    // it gets on or off a lift, or rides in it: it does not react to robots
};
AloneWalk WalkAlone(const PeopleView& view, PersonId id, PersonState& person);

}  // namespace troupe
