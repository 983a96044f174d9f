// The crowd of a building: from the states, goals and groups of its `crowd_sim` to goal sets and rules for people
// (people.h).
//
// A state becomes a goal set with the vertices of its areas, on all levels; a group becomes a rule whose people start
// around the point of the group, where they can walk to it. What stands for nothing is a warning with its place: a
// group outside of the floors, a state without goals.
#pragma once

#include "troupe/result.h"
#include "worldfile/models/build_world.h"

namespace troupe {

// The world of a building with the people of its crowd_sim, if that is enabled.
Result<LoadedWorld> AddCrowd(LoadedWorld loaded);

}  // namespace troupe
