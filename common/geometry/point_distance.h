// Distances of points from segments and outlines, in the plane and in the unit of their coordinates.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "troupe/polygon.h"
#include "troupe/vec2.h"

namespace troupe {

// From the segment between a and b, which may be one point.
inline double DistanceToSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 way = b - a;
  const Vec2 offset = p - a;
  const double squared = way.squaredNorm();
  const double along = squared > 0.0 ? std::clamp(offset.dot(way) / squared, 0.0, 1.0) : 0.0;
  return (offset - along * way).norm();
}

// From the nearest edge of an outline, also for a point inside; infinite without a corner.
inline double DistanceToEdges(const Polygon& outline, const Vec2& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    least = std::min(least, DistanceToSegment(p, outline[i], outline[(i + 1) % outline.size()]));
  }
  return least;
}

}  // namespace troupe
