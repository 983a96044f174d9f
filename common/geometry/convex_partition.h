// Cuts a simple polygon into convex pieces, because the exact tests (overlap, sweep, ray) are simple on convex ones.
#pragma once

#include <vector>

#include "troupe/polygon.h"

namespace troupe {

// REQUIRES: the polygon is normalized (polygon.h). The pieces are convex and counter-clockwise, do not overlap, use
// only the polygon's vertices and cover it exactly. At most four times as many as the fewest possible (ear clipping,
// then Hertel and Mehlhorn 1983: drop every diagonal that both sides can do without).
std::vector<Polygon> ConvexPartition(const Polygon& polygon);

}  // namespace troupe
