// Simple polygons: closed, not crossing themselves, possibly concave. Vertices in metres, without repeating the first.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/geometry/rectangle.h"
#include "common/geometry/vec2.h"

namespace troupe {

using Polygon = std::vector<Vec2>;

// Positive if counter-clockwise; m^2.
double SignedArea(const Polygon& polygon);

Rectangle BoundingBox(std::span<const Vec2> polygon);

// True if p lies inside or on the edge.
bool Contains(const Polygon& polygon, const Vec2& p);

// Makes a polygon usable as the outline of a block: drops repeated and collinear vertices, turns it counter-clockwise.
// Returns "" and changes the polygon, or returns what is wrong with it (fewer than three vertices, no area, edges that
// cross, a number that is not finite) and leaves it alone.
std::string Normalize(Polygon& polygon);

}  // namespace troupe
