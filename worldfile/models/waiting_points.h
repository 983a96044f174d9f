// Waiting points: vertices on the lanes of planned traffic, between those of the site, at which robots may stop.
//
// A plan grants lanes as a whole, and on a site they are as long as a corridor. With points on them, robots follow each
// other along a corridor, and make room for others within it; without them, the robots of a site whose lanes form a
// tree soon stand in each other's ways.
//
// A long lane is cut into lanes of equal length, which keep its properties. A point has no name, follows the vertices
// of the site, and is as far from them, from other points of its lane and from the leaves of doors, however they stand,
// as two robots of the graph keep apart. Lanes of a mutex group, and those at lifts, remain whole.
#pragma once

#include <cstddef>

#include "troupe/world_description.h"

namespace troupe {

// Adds them to the graphs on which a robot of the world takes part in planned traffic (controller `lanes`). Not to
// those of a problem of multi-agent paths, whose steps are lanes.
// Cost: points times leaves of doors.
void AddWaitingPoints(WorldDescription& world);
// To one graph of the world. `radius`: m, of the largest robot on it.
void AddWaitingPoints(WorldDescription& world, std::size_t graph, double radius);

}  // namespace troupe
