// The goals of people, one after another. Private to this folder.
#pragma once

#include <cstdint>

#include "troupe/ids.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// The ticks next to a time in seconds.
std::uint32_t TicksOf(const WorldDescription& world, double seconds);

// Sets the next goal: at first one of the person's own set, then one of a set that may follow. Nothing changes after
// the last set. A pure function of the world's seed, the person and the number of its choices.
void ChooseGoal(const WorldDescription& world, PersonId id, PersonState& person);

// The person is at its goal: it waits there, or chooses the next one.
void ArriveAtGoal(const WorldDescription& world, PersonId id, PersonState& person);

}  // namespace troupe
