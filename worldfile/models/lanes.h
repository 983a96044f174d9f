// The levels and the lanes of a building for the robots of its world.
#pragma once

#include <vector>

#include "troupe/world_description.h"
#include "worldfile/sites/site.h"

namespace troupe {

// Those of the site, ascending; those of one height are one.
std::vector<LevelDescription> LevelsOf(const Site& site);
// The floors of the lifts of a world without a site, likewise.
std::vector<LevelDescription> LevelsOf(const std::vector<LiftDescription>& lifts);

// The graphs of the site, by number. A lane through a door that nothing operates is left out, and no ride is in a lift
// that nothing operates. The world has the doors and lifts of the site, or some of them.
std::vector<LaneGraph> LaneGraphsOf(const Site& site, const WorldDescription& world);

}  // namespace troupe
