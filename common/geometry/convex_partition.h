// Cuts a simple polygon into convex pieces, because the exact tests (overlap, sweep, ray) are simple on convex ones.
//
// Ear clipping takes time quadratic to cubic in the vertices in the worst case, of which an outline has at most 10,000;
// a loader does it once for each block. The order of the cuts depends on the order of the vertices alone, so that all
// processes number the pieces equally.
#pragma once

#include <vector>

#include "troupe/polygon.h"

namespace troupe {

// REQUIRES: the polygon is normalized (polygon.h). The pieces are convex and counter-clockwise, do not overlap, use
// only the polygon's vertices and cover it exactly. At most four times as many as the fewest possible (ear clipping,
// then Hertel and Mehlhorn 1983: drop every diagonal that both sides can do without).
std::vector<Polygon> ConvexPartition(const Polygon& polygon);

}  // namespace troupe
