// Points and directions in the plane, in metres unless a name has another unit.
//
// Eigen's fixed-size vector: no allocation, and vector instructions where the compiler finds them. Products are not
// fused (-ffp-contract=off), so that the bits do not depend on the processor.
#pragma once

#include <Eigen/Core>

namespace troupe {

using Vec2 = Eigen::Vector2d;

// z component of the cross product: positive if b lies to the left of a.
inline double Cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace troupe
