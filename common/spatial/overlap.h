// Overlap of convex polygons.
#pragma once

#include <span>

#include "common/geometry/vec2.h"

namespace troupe {

// How deep two convex, counter-clockwise polygons overlap: the smallest distance (m) by which one of them would have to
// move to come free (separating axis theorem). Zero or negative if they do not overlap in area; then its size is a
// lower bound of their distance.
double PenetrationDepth(std::span<const Vec2> a, std::span<const Vec2> b);

}  // namespace troupe
