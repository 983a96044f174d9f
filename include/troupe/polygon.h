// Simple polygons: closed, not crossing themselves, possibly concave. Vertices in metres, without repeating the first.
//
// A polygon is a plain list of corners; only Normalized makes it an outline, which all other code may rely on:
// counter-clockwise, simple, no repeated and no collinear corners. Normalizing twice changes nothing.
#pragma once

#include <span>
#include <vector>

#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "troupe/vec2.h"

namespace troupe {

using Polygon = std::vector<Vec2>;

// Positive if counter-clockwise; m^2.
double SignedArea(const Polygon& polygon);

Rectangle BoundingBox(std::span<const Vec2> polygon);

// Normalized, with its middle at the origin, its corners at `radius` (m) and one of its sides across the x axis.
// REQUIRES: at least three sides.
Polygon RegularPolygon(int sides, double radius);

// True if p lies inside or on the edge.
bool Contains(const Polygon& polygon, const Vec2& p);

// The polygon as the outline of a block: counter-clockwise, without repeated and collinear vertices. An error, with a
// message without a place, for fewer than three vertices, no area, edges that cross, or a number that is not finite or
// beyond kMaxMagnitude.
Result<Polygon> Normalized(Polygon polygon);

}  // namespace troupe
