// The lanes of a map of cells, and the trips of its agents.
#pragma once

#include "troupe/result.h"
#include "troupe/world_description.h"
#include "worldfile/grids/grid_problem.h"

namespace troupe {

// Beyond this many free cells a world has no lanes: their graph would need more than a GB.
inline constexpr std::size_t kMaxLaneCells = 400'000;

// Adds the lanes to a world, which has the robots of the agents: a vertex in each free cell, by rows from the top, and
// lanes both ways between cells with a side in common. Then the trips of the agents' robots, without those that the
// world does not have. The error is a problem with agents on a map that is too large; a map alone has no lanes then.
Status AddGrid(const GridProblem& problem, WorldDescription& world);

}  // namespace troupe
