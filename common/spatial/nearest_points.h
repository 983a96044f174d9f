// The nearest points of two convex outlines.
#pragma once

#include <span>

#include "troupe/vec2.h"

namespace troupe {

struct NearestPoints {
  double distance = 0.0;  // m; 0 if they touch or overlap
  Vec2 a{0.0, 0.0};       // m, a point of the first
  Vec2 b{0.0, 0.0};       // of the second; equal to `a` if they overlap
};

// Of two convex polygons, counter-clockwise. Two vertices are a segment, one is a point. REQUIRES: each has a vertex
NearestPoints FindNearestPoints(std::span<const Vec2> a, std::span<const Vec2> b);

}  // namespace troupe
