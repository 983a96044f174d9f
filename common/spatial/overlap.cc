#include "common/spatial/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace troupe {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// The gaps between `a` and `b` along the outward normals of a's edges, negative where they overlap, until visit(gap)
// returns false; then false.
template <typename Visit>
bool ForEachGap(std::span<const Vec2> a, std::span<const Vec2> b, Visit visit) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2& start = a[i];
    const Vec2 along = a[i + 1 < a.size() ? i + 1 : 0] - start;
    const double length = std::sqrt(along.squaredNorm());
    if (length == 0.0) continue;
    double gap = kUnbounded;
    for (const Vec2& vertex : b) gap = std::min(gap, -Cross(along, vertex - start));
    if (!visit(gap / length)) return false;
  }
  return true;
}

// The distances of points beyond the line along `along` through `start`, on its outer side, times its length: the least
// and the most.
struct Beyond {
  double least = kUnbounded;
  double most = -kUnbounded;

  void Add(const Vec2& start, const Vec2& along, std::span<const Vec2> points) {
    for (const Vec2& point : points) {
      const double beyond = -Cross(along, point - start);
      least = std::min(least, beyond);
      most = std::max(most, beyond);
    }
  }
};

// `gap`: times the length of `along`. Without a root or a division.
bool IsMoreThan(double gap, double margin, const Vec2& along) {
  return gap > 0.0 && gap * gap > margin * margin * along.squaredNorm();
}

}  // namespace

double PenetrationDepth(std::span<const Vec2> a, std::span<const Vec2> b) {
  double largest = -kUnbounded;
  const auto keep_largest = [&largest](double gap) {
    largest = std::max(largest, gap);
    return true;
  };
  ForEachGap(a, b, keep_largest);
  ForEachGap(b, a, keep_largest);
  return -largest;
}

bool OverlapBy(std::span<const Vec2> a, std::span<const Vec2> b, double depth) {
  const auto overlaps = [depth](double gap) { return -gap > depth; };
  return ForEachGap(a, b, overlaps) && ForEachGap(b, a, overlaps);
}

bool StayApart(std::span<const Vec2> a, std::span<const Vec2> a_later, std::span<const Vec2> b, double margin) {
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Vec2 along = b[i + 1 < b.size() ? i + 1 : 0] - b[i];
    Beyond mover;
    mover.Add(b[i], along, a);
    mover.Add(b[i], along, a_later);
    if (IsMoreThan(mover.least, margin, along)) return true;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2 along = a[i + 1 < a.size() ? i + 1 : 0] - a[i];
    Beyond mover;
    mover.Add(a[i], along, a);
    mover.Add(a[i], along, a_later);
    Beyond obstacle;
    obstacle.Add(a[i], along, b);
    if (IsMoreThan(obstacle.least - mover.most, margin, along)) return true;
  }
  return false;
}

bool OverlapBy(const ConvexPiece& a, const ConvexPiece& b, double depth) {
  return a.z.Overlaps(b.z) && OverlapBy(a.vertices, b.vertices, depth);
}

}  // namespace troupe
