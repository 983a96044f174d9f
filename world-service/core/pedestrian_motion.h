// PeopleMover: the second half of a tick of people. Each person moves by its plan, one after another, as far as there
// is room; each sees the new poses of its predecessors. Private to this folder.
//
// Plans were made from the state before, by people who could not know each other's plans, so that a plan may lead into
// another person. The mover is what keeps bodies apart: it shortens a move to a half, then to a quarter, then leaves it
// out. It tests the cylinder of the person first, which is quick and almost always free. Only where others are inside
// the cylinder already (a person that a leaf or a cabin has come near to) is the true body swept.
//
// One thread, after all people have decided. The order of people is a function of the tick (people.cc).
#pragma once

#include "world-service/core/person_room.h"

namespace troupe {

class PeopleMover {
 public:
  explicit PeopleMover(StepWorkspace& workspace) : workspace_(workspace), room_(workspace) {}

  // Executes a plan: takes over its progress through goals and lifts, and moves the person by its velocity as far as
  // there is room. The velocity in the state is the executed one.
  void Move(PersonId id, const PersonState& plan);

 private:
  // True at rest.
  bool IsFree(PersonId id, const Pose& X_WP, const Vec2& velocity) const;

  StepWorkspace& workspace_;
  PersonRoom room_;
};

}  // namespace troupe
