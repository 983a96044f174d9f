// The levels and the lanes of a building for the robots of its world: what a planner of routes needs, without walls.
//
// Graphs are independent: vehicles of different fleets have graphs of different numbers. A lane refers to vertices,
// doors and lifts by index into the same description, in a stable order (levels, then vertices of the file). Positions
// in m, frame W; `at` of a door is metres along the lane from its start.
#pragma once

#include <vector>

#include "troupe/world_description.h"
#include "worldfile/sites/site.h"

namespace troupe {

// The levels of the site by ascending height; levels less than half a metre apart are one.
std::vector<LevelDescription> LevelsOf(const Site& site);
// The floors of the lifts of a world without a site, by the same rules.
std::vector<LevelDescription> LevelsOf(const std::vector<LiftDescription>& lifts);

// The graphs of the site, by number. A lane through a door that nothing operates is left out, and no ride is in a lift
// that nothing operates. The world has the doors and lifts of the site, or some of them.
std::vector<LaneGraph> LaneGraphsOf(const Site& site, const WorldDescription& world);

}  // namespace troupe
