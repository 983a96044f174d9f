// The edges of a level's floors over a void: not along a wall, not where another floor or the cabin of a lift goes on.
//
// Robots and people move on a level and cannot fall, so that the world has a railing there: a body that others hit and
// no ray sees (site_tree.cc). Floors and cabins that are up to kGap apart are one, since a wheel rolls over the joint.
#pragma once

#include <vector>

#include "troupe/vec2.h"
#include "worldfile/sites/site.h"

namespace troupe {

// A part of the outline of a floor, m, frame W, with the floor to the left of the way from `from` to `to`.
struct FloorEdge {
  Vec2 from{0.0, 0.0};
  Vec2 to{0.0, 0.0};
};

// In the order of the floors; none on the lowest level, which is on the ground.
std::vector<FloorEdge> FindFloorEdges(const Site& site, const SiteLevel& level);

}  // namespace troupe
