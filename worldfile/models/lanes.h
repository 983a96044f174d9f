// The lanes of a building for the robots that follow them.
#pragma once

#include "troupe/result.h"
#include "worldfile/models/build_world.h"

namespace troupe {

// Gives the lanes of the world's building to each robot with the controller `lanes`, as its parameter `graph`, unless
// it has an object there: those of the graph with the number that it has there, or of the graph of the lane nearest to
// its start. A lane through a door that nothing operates, and one into a lift that nothing operates, is left out. The
// error: no lane has that number, or the check of `overrides` finds a fault in the parameters.
Result<LoadedWorld> AddLanes(LoadedWorld loaded, const LoadOverrides& overrides);

}  // namespace troupe
