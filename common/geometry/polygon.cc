#include "troupe/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/geometry/limits.h"
#include "troupe/deterministic_math.h"
#include "troupe/z_range.h"

namespace troupe {
namespace {

// More vertices than any outline needs; it keeps the quadratic algorithms on outlines harmless for any input.
constexpr std::size_t kMaxVertices = 10'000;

// Distance of p from the line through a and b, positive on its left; the distance from a if a and b coincide. Metres.
double SignedDistance(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 along = b - a;
  const double length = along.norm();
  return length > 0.0 ? Cross(along, p - a) / length : (p - a).norm();
}

// True if `middle` adds nothing to the outline between its neighbours: it repeats one of them, lies on the straight
// line between them, or is the tip of a spike without area.
bool IsRedundant(const Vec2& before, const Vec2& middle, const Vec2& after) {
  if ((middle - before).norm() <= kTouchTolerance || (after - middle).norm() <= kTouchTolerance) return true;
  const Vec2 in = middle - before;
  const Vec2 out = after - middle;
  if (in.dot(out) > 0.0) return std::abs(SignedDistance(before, after, middle)) <= kTouchTolerance;
  // A spike: the shorter of the two edges lies on the longer one.
  return in.squaredNorm() > out.squaredNorm() ? std::abs(SignedDistance(before, middle, after)) <= kTouchTolerance
                                              : std::abs(SignedDistance(middle, after, before)) <= kTouchTolerance;
}

void DropRedundantVertices(Polygon& polygon) {
  bool changed = true;
  // Dropping a vertex may make its neighbours redundant.
  while (changed && polygon.size() >= 3) {
    changed = false;
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const std::size_t left = polygon.size() - i;  // vertices not tested yet, this one included
      const Vec2& before = kept.empty() ? polygon.back() : kept.back();
      const Vec2& after = left > 1 ? polygon[i + 1] : (kept.empty() ? polygon.front() : kept.front());
      if (kept.size() + left >= 3 && IsRedundant(before, polygon[i], after)) {
        changed = true;
      } else {
        kept.push_back(polygon[i]);
      }
    }
    polygon = std::move(kept);
  }
}

// True if the segments cross, each passing from one side of the other to the other side. Touching is not crossing.
bool SegmentsCross(const Vec2& a0, const Vec2& a1, const Vec2& b0, const Vec2& b1) {
  const auto separates = [](const Vec2& p, const Vec2& q, const Vec2& r0, const Vec2& r1) {
    const double d0 = SignedDistance(p, q, r0);
    const double d1 = SignedDistance(p, q, r1);
    return (d0 > kTouchTolerance && d1 < -kTouchTolerance) || (d0 < -kTouchTolerance && d1 > kTouchTolerance);
  };
  return separates(a0, a1, b0, b1) && separates(b0, b1, a0, a1);
}

bool AnyEdgesCross(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  const auto min_x = [&](std::size_t edge) { return std::min(polygon[edge].x(), polygon[(edge + 1) % n].x()); };
  const auto max_x = [&](std::size_t edge) { return std::max(polygon[edge].x(), polygon[(edge + 1) % n].x()); };
  std::vector<std::size_t> by_min_x(n);
  std::iota(by_min_x.begin(), by_min_x.end(), std::size_t{0});
  // A sweep along x: only edges whose intervals overlap are compared. Equal starts may come in any order: the answer is
  // the same.
  std::sort(by_min_x.begin(), by_min_x.end(), [&](std::size_t a, std::size_t b) { return min_x(a) < min_x(b); });
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = by_min_x[i];
    for (std::size_t j = i + 1; j < n && min_x(by_min_x[j]) <= max_x(a); ++j) {
      const std::size_t b = by_min_x[j];
      if (SegmentsCross(polygon[a], polygon[(a + 1) % n], polygon[b], polygon[(b + 1) % n])) return true;
    }
  }
  return false;
}

}  // namespace

double SignedArea(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    // Relative to the first vertex: far from the origin, products of coordinates would lose the area's digits.
    twice += Cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  return 0.5 * twice;
}

Rectangle BoundingBox(std::span<const Vec2> polygon) {
  const Rectangle nothing = Rectangle::Nothing();
  Vec2 min(nothing.min_x, nothing.min_y);
  Vec2 max(nothing.max_x, nothing.max_y);
  for (const Vec2& vertex : polygon) {
    min = min.cwiseMin(vertex);
    max = max.cwiseMax(vertex);
  }
  return {min.x(), min.y(), max.x(), max.y()};
}

bool Contains(const Polygon& polygon, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[(i + 1) % polygon.size()];
    const double side = Cross(b - a, p - a);
    if (side == 0.0 && (p - a).dot(p - b) <= 0.0) return true;
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if ((side > 0.0) == (b.y() > a.y())) inside = !inside;  // the edge crosses the ray from p towards +x
  }
  return inside;
}

Result<Polygon> Normalized(Polygon polygon) {
  const auto fault = [](std::string message) { return Error{{}, std::move(message)}; };
  for (const Vec2& vertex : polygon) {
    if (!std::isfinite(vertex.x()) || !std::isfinite(vertex.y())) return fault("a coordinate is not a finite number");
    if (vertex.cwiseAbs().maxCoeff() > kMaxMagnitude) return fault("a coordinate is beyond 1000 km");
  }
  if (polygon.size() < 3) {
    return fault("found " + std::to_string(polygon.size()) + " vertices, expected at least 3");
  }
  if (polygon.size() > kMaxVertices) {
    return fault("found " + std::to_string(polygon.size()) + " vertices, expected at most " +
                 std::to_string(kMaxVertices));
  }
  // Before the other tests, which take the outline as counter-clockwise.
  if (SignedArea(polygon) < 0.0) std::reverse(polygon.begin(), polygon.end());
  DropRedundantVertices(polygon);
  if (polygon.size() < 3) return fault("the outline has no area");
  if (AnyEdgesCross(polygon)) return fault("edges of the outline cross each other");
  if (!(SignedArea(polygon) > 0.0)) return fault("the outline has no area");
  return polygon;
}

Polygon RegularPolygon(int sides, double radius) {
  Polygon outline;
  for (int i = 0; i < sides; ++i) {
    const auto [sine, cosine] = SinCos(2.0 * kPi * (i + 0.5) / sides);
    outline.emplace_back(radius * cosine, radius * sine);
  }
  return Normalized(std::move(outline)).value();
}

}  // namespace troupe
