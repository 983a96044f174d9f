// The goals of people, one after another: a random walk over goal sets (GoalSet), weighted by the file. Private to this
// folder.
//
// Each draw is a function of the world's seed, the person and the number of its choice so far, never of the tick or of
// earlier draws. So the goals of a person do not change when others walk differently, when a run is continued from a
// snapshot, or by the thread that decides. A person alone chooses; a follower copies the goals of its leader
// (preferred_velocity.cc).
#pragma once

#include <cstdint>

#include "troupe/ids.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

// The ticks next to a time in seconds.
// At most 1e9, which fits into the counts of a state.
std::uint32_t TicksOf(const WorldDescription& world, double seconds);

// Sets the next goal: at first a point of the person's own set, then one of a set that may follow. Nothing changes
// after the last set. A pure function of the world's seed, the person and the number of its choices.
void ChooseGoal(const WorldDescription& world, PersonId id, PersonState& person);

// The first goal of a visit: a point of the person's own set.
void ChooseFirstGoal(const WorldDescription& world, PersonId id, PersonState& person);

// The points of the goal set are exits.
bool IsExit(const WorldDescription& world, std::uint32_t goals);

// The person is at its goal: it waits there, or chooses the next one.
void ArriveAtGoal(const WorldDescription& world, PersonId id, PersonState& person);

}  // namespace troupe
