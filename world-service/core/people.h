// People: the walks of all persons in one tick. Private to this folder.
//
// All people first decide at the same time, each from the state before the tick and the robots after it: its goal, the
// velocity with which it comes nearest to its way there without meeting others (ORCA), and its heading. Then they move
// one after another, in an order that is a fixed function of the tick; each sees the new poses of its predecessors. A
// person is an upright cylinder of its radius for others. A move that would bring it into a wall or a body is shortened
// to a half, to a quarter, and is then left out: no person is ever in another body. A person on whose head an object
// rests stands still.
//
// A decision has three parts: the goal and the velocity that a person would have alone
// (preferred_velocity.h), its reaction to robots, its steering among others and their avoidance (avoidance.h), and its
// heading, which others see and take for its way. The parts read one PeopleView and write one plan, so that any number
// of threads gives the same plans. Moves (pedestrian_motion.h) are by one thread, because each depends on the previous
// ones; they take far less time than the decisions.
#pragma once

#include "common/base/thread_pool.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// Moves all people by one tick. `pool`: of the threads that decide, which change nothing in the result; may be null.
void MovePeople(StepWorkspace& workspace, ThreadPool* pool);

}  // namespace troupe
