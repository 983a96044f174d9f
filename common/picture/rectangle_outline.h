// The outline of a union of rectangles: a picture of it has no seams between rectangles that touch, and far fewer
// edges.
//
// Edges of neighbours coincide and cancel; what remains is joined to loops. Coordinates become ranks first, so that
// edges are compared as integers. O(n log n).
#pragma once

#include <vector>

#include "troupe/polygon.h"
#include "troupe/rectangle.h"

namespace troupe {

// Loops around the union of rectangles that do not overlap; the union is the area inside an odd number of loops. Edges
// closer than 1e-9 of the whole extent count as shared.
std::vector<Polygon> OutlineOf(const std::vector<Rectangle>& rectangles);

}  // namespace troupe
