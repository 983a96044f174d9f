// TickView: what monitors see of a tick. A live simulation, the step of a recording and a branch supply the same
// values, so that they have the same verdicts.
#pragma once

#include <span>

#include "common/sensing/sensor.h"
#include "troupe/event.h"
#include "troupe/expectation.h"
#include "troupe/world_state.h"

namespace troupe {

// Borrowed for the time of a call of Monitor::Push. All signals follow from it: readings are measured from the state,
// which gives the bits that the robots read, and the state hash is computed only for formulas that name it.
// Events are the one part that a state does not contain: a recording stores them beside its states for this purpose.
struct TickView {
  const Scene& scene;
  const BodyIndex& bodies;        // at `state`, an index of `scene`
  const WorldState& state;        // its tick is the tick
  std::span<const Event> events;  // of the step to this tick; empty at the first one
};

}  // namespace troupe
