// The distance of a point from a segment, by the plain formula: a reference for the project's own.
#pragma once

#include <algorithm>

#include "troupe/vec2.h"

namespace troupe::test {

// m. REQUIRES: from and to differ
inline double DistanceToEdge(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 edge = to - from;
  const double along = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (point - from - along * edge).norm();
}

}  // namespace troupe::test
