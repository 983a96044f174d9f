#include "common/spatial/nearest_points.h"

#include <algorithm>
#include <limits>

namespace troupe {
namespace {

Vec2 NearestOnEdge(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double square = along.squaredNorm();
  if (square == 0.0) return from;
  return from + std::clamp((point - from).dot(along) / square, 0.0, 1.0) * along;
}

// For three vertices or more.
bool IsInside(std::span<const Vec2> polygon, const Vec2& point) {
  if (polygon.size() < 3) return false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& from = polygon[i];
    const Vec2& to = polygon[(i + 1) % polygon.size()];
    if (Cross(to - from, point - from) < 0.0) return false;
  }
  return true;
}

// True if the inner parts of two edges cross, at `at`.
bool EdgesCross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, Vec2& at) {
  const double c_side = troupe::Cross(b - a, c - a);
  const double d_side = troupe::Cross(b - a, d - a);
  const double a_side = troupe::Cross(d - c, a - c);
  const double b_side = troupe::Cross(d - c, b - c);
  if (!((c_side < 0.0) != (d_side < 0.0) && (a_side < 0.0) != (b_side < 0.0))) return false;
  if (c_side == d_side) return false;
  at = c + (d - c) * (c_side / (c_side - d_side));
  return true;
}

}  // namespace

NearestPoints FindNearestPoints(std::span<const Vec2> a, std::span<const Vec2> b) {
  if (IsInside(b, a.front())) return {0.0, a.front(), a.front()};
  if (IsInside(a, b.front())) return {0.0, b.front(), b.front()};
  NearestPoints nearest{std::numeric_limits<double>::infinity(), a.front(), b.front()};
  const auto keep = [&](const Vec2& of_a, const Vec2& of_b) {
    const double distance = (of_a - of_b).norm();
    if (distance < nearest.distance) nearest = {distance, of_a, of_b};
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2& a_from = a[i];
    const Vec2& a_to = a[(i + 1) % a.size()];
    for (std::size_t k = 0; k < b.size(); ++k) {
      const Vec2& b_from = b[k];
      const Vec2& b_to = b[(k + 1) % b.size()];
      Vec2 at;
      if (EdgesCross(a_from, a_to, b_from, b_to, at)) return {0.0, at, at};
      keep(a_from, NearestOnEdge(a_from, b_from, b_to));
      keep(NearestOnEdge(b_from, a_from, a_to), b_from);
    }
  }
  return nearest;
}

}  // namespace troupe
