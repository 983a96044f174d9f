// A ray's line, the exact distances along it at which it enters pieces, and the rule which hit is the nearest.
//
// The functions here define what a range is: every path of a cast (by boxes, by polygons, in the frame of a link, one
// by one or in blocks) ends in one of them, or in arithmetic that gives the same bits. They are inline because they are
// the innermost loop of a simulation with scanners.
//
// Invariant: the side on which a vertex is depends on the vertex and the line alone, and never on the polygon. So
// pieces that share an edge leave no gap, and no result depends on how a wall was cut into pieces.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "common/spatial/convex_piece.h"
#include "common/spatial/ray_cast.h"
#include "troupe/ids.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"

namespace troupe {

// A ray's line.
struct RayLine {
  Vec2 origin;
  Vec2 direction;  // of length 1

  // False only if the ray does not hit the box before `distance`. Cheap, and never wrong by rounding.
  bool MayHit(const Rectangle& box, double distance) const {
    constexpr double kRayTolerance = 1e-8;  // m
    const Vec2 slant = direction.cwiseAbs();
    const Vec2 center(0.5 * (box.min_x + box.max_x) - origin.x(), 0.5 * (box.min_y + box.max_y) - origin.y());
    const Vec2 half(0.5 * (box.max_x - box.min_x) + kRayTolerance, 0.5 * (box.max_y - box.min_y) + kRayTolerance);
    const double along = direction.dot(center);
    const double reach = half.dot(slant);
    // One jump for all three, as none of them can be foreseen.
    return !(std::abs(Cross(direction, center)) > half.x() * slant.y() + half.y() * slant.x()) &
           (along + reach >= 0.0) & (along - reach <= distance);
  }
};

// The nearest hit so far.
struct NearestHit {
  double distance;  // m; the ray's length without a hit
  std::optional<ModelId> model;

  // A total order, by distance and then by model: the order in which pieces are tested does not matter.
  bool IsBeatenBy(double candidate, ModelId candidate_model) const {
    if (candidate != distance) return candidate < distance;
    return !model || candidate_model < *model;
  }
  std::optional<RayHit> hit() const {
    return model ? std::optional<RayHit>({.distance = distance, .model = *model}) : std::nullopt;
  }
};

// Distance along the ray's line to the edge from `before` to `here`, whose ends are on different sides of the line.
// Interpolated between the ends by their distances from the line, which have different signs: the denominator is not 0.
inline double Crossing(const RayLine& ray, const Vec2& before, double side_before, const Vec2& here, double side) {
  const double at_before = ray.direction.dot(before);
  return at_before + (ray.direction.dot(here) - at_before) * (side_before / (side_before - side));
}

// Distance at which the ray enters the convex polygon, 0 if it starts inside; negative without a hit. A polygon that
// ends at the ray's start is behind it.
//
// A vertex is left or right of the ray by the sign of one number that depends on nothing else, so that of two polygons
// that share a vertex at least one is hit: no ray slips through the joints between the rectangles of a wall.
inline double DistanceTo(std::span<const Vec2> vertices, const RayLine& ray) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double enter = kInfinity;
  double leave = -kInfinity;
  const auto add_crossing = [&](double at) {
    enter = std::min(enter, at);
    leave = std::max(leave, at);
  };
  Vec2 before = vertices.back() - ray.origin;
  double side_before = Cross(ray.direction, before);
  for (const Vec2& vertex : vertices) {
    const Vec2 here = vertex - ray.origin;
    const double side = Cross(ray.direction, here);
    if (side == 0.0) {
      add_crossing(ray.direction.dot(here));
    } else if ((side < 0.0 && side_before > 0.0) || (side > 0.0 && side_before < 0.0)) {
      add_crossing(Crossing(ray, before, side_before, here, side));
    }
    before = here;
    side_before = side;
  }
  return leave > kTouchTolerance ? std::max(enter, 0.0) : -1.0;
}

// A ray's line, prepared for tests against many boxes along the axes.
class BoxLine {
 public:
  explicit BoxLine(const RayLine& ray)
      : origin_(ray.origin),
        inverse_(ray.direction.array().inverse()),
        along_axis_((ray.direction.array() == 0.0).any()) {}

  // As DistanceTo. Two boxes that share a side give the same bits for it, so that no ray slips through between them.
  double DistanceTo(const Rectangle& box) const {
    if (along_axis_) return DistanceAlongAxis(box);
    return Entry((Eigen::Array2d(box.min_x, box.min_y) - origin_) * inverse_,
                 (Eigen::Array2d(box.max_x, box.max_y) - origin_) * inverse_);
  }
  const Eigen::Array2d& inverse() const { return inverse_; }

 private:
  // By the distances to the sides of a box.
  static double Entry(const Eigen::Array2d& at_min, const Eigen::Array2d& at_max) {
    const Eigen::Array2d enters = at_min.min(at_max);
    const Eigen::Array2d leaves = at_min.max(at_max);
    const double enter = std::max(enters.x(), enters.y());
    const double leave = std::min(leaves.x(), leaves.y());
    // One jump for both conditions: which of them fails cannot be foreseen.
    return ((enter <= leave) & (leave > kTouchTolerance)) ? std::max(enter, 0.0) : -1.0;
  }
  [[gnu::noinline]] double DistanceAlongAxis(const Rectangle& box) const {
    Eigen::Array2d at_min = (Eigen::Array2d(box.min_x, box.min_y) - origin_) * inverse_;
    Eigen::Array2d at_max = (Eigen::Array2d(box.max_x, box.max_y) - origin_) * inverse_;
    for (int i = 0; i < 2; ++i) {
      if (!std::isinf(inverse_[i])) continue;
      const double from = origin_[i];
      const bool within = i == 0 ? box.min_x <= from && from <= box.max_x : box.min_y <= from && from <= box.max_y;
      if (!within) return -1.0;
      at_min[i] = -kInfinity;
      at_max[i] = kInfinity;
    }
    return Entry(at_min, at_max);
  }

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Array2d origin_;
  Eigen::Array2d inverse_;  // 1 / direction by components
  bool along_axis_;
};

inline void KeepNearer(double distance, ModelId model, NearestHit& nearest) {
  if (distance >= 0.0 && nearest.IsBeatenBy(distance, model)) nearest = {distance, model};
}

}  // namespace troupe
