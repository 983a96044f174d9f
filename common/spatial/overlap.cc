#include "common/spatial/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe {
namespace {

// The largest gap between `a` and `b` along the outward normals of a's edges; negative if they overlap along all.
double LargestGap(std::span<const Vec2> a, std::span<const Vec2> b) {
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2& start = a[i];
    const Vec2 along = a[i + 1 < a.size() ? i + 1 : 0] - start;
    const double length = std::sqrt(along.squaredNorm());
    if (length == 0.0) continue;
    double gap = std::numeric_limits<double>::infinity();
    for (const Vec2& vertex : b) gap = std::min(gap, -Cross(along, vertex - start));
    largest = std::max(largest, gap / length);
  }
  return largest;
}

}  // namespace

double PenetrationDepth(std::span<const Vec2> a, std::span<const Vec2> b) {
  return -std::max(LargestGap(a, b), LargestGap(b, a));
}

bool OverlapBy(const ConvexPiece& a, const ConvexPiece& b, double depth) {
  return a.z.Overlaps(b.z) && PenetrationDepth(a.vertices, b.vertices) > depth;
}

}  // namespace troupe
