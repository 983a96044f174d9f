#include "common/spatial/ray_cast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/deterministic_math.h"

namespace troupe {
namespace {

struct Ray {
  Vec2 origin;
  Vec2 direction;
  Vec2 slant;    // |direction| by components
  Vec2 inverse;  // 1 / direction by components

  Ray(const Vec2& from, const Vec2& towards)
      : origin(from), direction(towards), slant(towards.cwiseAbs()), inverse(towards.cwiseInverse()) {}

  // False only if the ray does not meet the box before `distance`. Cheap, and never wrong by rounding.
  bool MayMeet(const Rectangle& box, double distance) const {
    constexpr double kHair = 1e-8;  // m
    const Vec2 center(0.5 * (box.min_x + box.max_x) - origin.x(), 0.5 * (box.min_y + box.max_y) - origin.y());
    const Vec2 half(0.5 * (box.max_x - box.min_x) + kHair, 0.5 * (box.max_y - box.min_y) + kHair);
    if (std::abs(Cross(direction, center)) > half.x() * slant.y() + half.y() * slant.x()) return false;
    const double along = direction.dot(center);
    const double reach = half.dot(slant);
    return along + reach >= 0.0 && along - reach <= distance;
  }
};

// The nearest meeting so far.
struct Nearest {
  double distance;  // m; the ray's length as long as nothing is met
  std::optional<ModelId> model;

  bool IsBeatenBy(double candidate, ModelId candidate_model) const {
    if (candidate != distance) return candidate < distance;
    return !model || candidate_model < *model;
  }
  std::optional<RayHit> hit() const {
    return model ? std::optional<RayHit>({.distance = distance, .model = *model}) : std::nullopt;
  }
};

bool IsSeenAt(const ConvexPiece& piece, double z) {
  return piece.ranger_return >= 0.0 && piece.z.Contains(z);
}

// Distance at which the ray enters the convex polygon, 0 if it starts inside; negative if it does not meet it. A
// polygon that ends where the ray starts is behind it.
//
// A vertex is left or right of the ray by the sign of one number that depends on nothing else, so that of two polygons
// that share a vertex at least one is met: no ray slips through where the rectangles of a wall join.
double DistanceTo(std::span<const Vec2> vertices, const Ray& ray) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double enter = kInfinity;
  double leave = -kInfinity;
  const auto meet = [&](double at) {
    enter = std::min(enter, at);
    leave = std::max(leave, at);
  };
  Vec2 before = vertices.back() - ray.origin;
  double side_before = Cross(ray.direction, before);
  for (const Vec2& vertex : vertices) {
    const Vec2 here = vertex - ray.origin;
    const double side = Cross(ray.direction, here);
    if (side == 0.0) {
      meet(ray.direction.dot(here));
    } else if ((side < 0.0 && side_before > 0.0) || (side > 0.0 && side_before < 0.0)) {
      const double at_before = ray.direction.dot(before);
      meet(at_before + (ray.direction.dot(here) - at_before) * (side_before / (side_before - side)));
    }
    before = here;
    side_before = side;
  }
  return leave > kTouchTolerance ? std::max(enter, 0.0) : -1.0;
}

// The same for a box along the axes. Two boxes that share a side give the same bits for it, so that no ray slips
// through between them.
double DistanceTo(const Rectangle& box, const Ray& ray) {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  const auto cut = [&](double from, double along, double inverse, double low, double high) {
    if (along == 0.0) {
      if (from < low || from > high) leave = -1.0;
      return;
    }
    const double a = (low - from) * inverse;
    const double b = (high - from) * inverse;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  };
  cut(ray.origin.x(), ray.direction.x(), ray.inverse.x(), box.min_x, box.max_x);
  cut(ray.origin.y(), ray.direction.y(), ray.inverse.y(), box.min_y, box.max_y);
  return enter <= leave && leave > kTouchTolerance ? std::max(enter, 0.0) : -1.0;
}

void Meet(double distance, ModelId model, Nearest& nearest) {
  if (distance >= 0.0 && nearest.IsBeatenBy(distance, model)) nearest = {distance, model};
}

void MeetPolygon(std::span<const Vec2> vertices, ModelId model, const Ray& ray, Nearest& nearest) {
  Meet(DistanceTo(vertices, ray), model, nearest);
}

void MeetStandingPieces(const StaticIndex& index, const Ray& ray, double z, Nearest& nearest) {
  // The walk's own distances round too; a hair more keeps what is met exactly where a cell begins.
  constexpr double kHair = 1e-8;  // m
  index.WalkRay(ray.origin, ray.direction, nearest.distance, [&](std::span<const std::uint32_t> pieces, double walked) {
    if (walked > nearest.distance + kHair) return false;
    for (std::uint32_t i : pieces) {
      const StaticIndex::RayPiece& piece = index.ray_piece(i);
      if (piece.is_box) {
        if (piece.z.Contains(z)) Meet(DistanceTo(piece.box, ray), piece.model, nearest);
        continue;
      }
      if (!ray.MayMeet(piece.box, nearest.distance) || !piece.z.Contains(z)) continue;
      MeetPolygon(index.vertices(piece), piece.model, ray, nearest);
    }
    return true;
  });
}

// A piece of a candidate and the box around it.
struct SeenPiece {
  const ConvexPiece* piece;
  Rectangle box;
};

Vec2 DirectionOf(double angle) {
  const SinCosResult trig = SinCos(angle);
  return {trig.cos, trig.sin};
}

// The bearings of a fan in ascending order.
class SortedBearings {
 public:
  explicit SortedBearings(std::span<const double> bearings) : bearings_(bearings), order_(bearings.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    if (!std::is_sorted(bearings.begin(), bearings.end())) {
      std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return bearings[a] < bearings[b]; });
    }
  }

  // Calls visit(ray) for the rays whose bearings are in [low, high], or a full turn or several away from it.
  template <typename Visit>
  void ForEachWithin(double low, double high, Visit visit) const {
    if (order_.empty()) return;
    const double lowest = bearings_[order_.front()];
    const double highest = bearings_[order_.back()];
    const double margin = 1e-9 * (1.0 + std::max(std::abs(lowest), std::abs(highest)));
    const double turn = 2.0 * kPi;
    const double first_turn = std::ceil((lowest - margin - high) / turn);
    for (double turns = first_turn; low + turns * turn <= highest + margin; turns += 1.0) {
      auto at = std::lower_bound(order_.begin(), order_.end(), low + turns * turn - margin,
                                 [&](std::size_t ray, double bearing) { return bearings_[ray] < bearing; });
      for (; at != order_.end() && bearings_[*at] <= high + turns * turn + margin; ++at) visit(*at);
    }
  }

 private:
  std::span<const double> bearings_;
  std::vector<std::size_t> order_;
};

// The angles under which a circle is seen from outside: its centre +- this. pi: all around.
double HalfWidth(double distance, double radius) {
  if (distance <= radius) return kPi;
  return Atan2(radius, std::sqrt((distance - radius) * (distance + radius)));
}

Rectangle BoxOf(const Vec2& origin, const Vec2& end) {
  Rectangle box = Rectangle::Nothing();
  box.Extend(origin);
  box.Extend(end);
  return box;
}

}  // namespace

RayCaster::RayCaster(const Scene& scene, const BodyIndex& bodies, const Rectangle& box, std::optional<RobotId> caster)
    : scene_(scene), bodies_(bodies) {
  std::vector<BodyId> near;
  bodies.Query(box, near);
  candidates_.reserve(near.size());
  for (BodyId id : near) {
    if (caster && bodies.owner(id) == caster) continue;
    const Body& body = scene.body(id);
    if (body.pieces.empty()) continue;
    const Pose& X_WB = bodies.X_WB(id);
    candidates_.push_back({id, X_WB.translation(), body.radius * (1.0 + 1e-9) + 1e-9, body.z + X_WB.z});
  }
}

std::optional<RayHit> RayCaster::CastRay(const Vec2& origin, const Vec2& direction, double z,
                                         double max_distance) const {
  const Ray ray{origin, direction};
  Nearest nearest{max_distance, std::nullopt};
  MeetStandingPieces(scene_.static_index(), ray, z, nearest);
  for (const Candidate& candidate : candidates_) {
    const Vec2 center = candidate.center - origin;
    if (std::abs(Cross(direction, center)) > candidate.radius) continue;
    const double along = direction.dot(center);
    if (along < -candidate.radius || along > nearest.distance + candidate.radius) continue;
    if (!candidate.z.Contains(z)) continue;
    for (const ConvexPiece& piece : bodies_.pieces_in_world(candidate.body)) {
      if (IsSeenAt(piece, z)) MeetPolygon(piece.vertices, piece.model, ray, nearest);
    }
  }
  return nearest.hit();
}

void RayCaster::CastFan(const Vec2& origin, double heading, std::span<const double> bearings, double z,
                        double max_distance, std::vector<std::optional<RayHit>>& hits) const {
  std::vector<Vec2> directions(bearings.size());
  std::vector<Nearest> nearest(bearings.size(), {max_distance, std::nullopt});
  double farthest = 0.0;
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    directions[i] = DirectionOf(heading + bearings[i]);
    MeetStandingPieces(scene_.static_index(), {origin, directions[i]}, z, nearest[i]);
    farthest = std::max(farthest, nearest[i].distance);
  }

  const SortedBearings sorted(bearings);
  std::vector<SeenPiece> seen;
  for (const Candidate& candidate : candidates_) {
    const Vec2 center = candidate.center - origin;
    const double distance = std::sqrt(center.squaredNorm());
    if (distance - candidate.radius > farthest || !candidate.z.Contains(z)) continue;
    seen.clear();
    const auto meet = [&](std::size_t i) {
      if (distance - candidate.radius > nearest[i].distance) return;
      if (seen.empty()) {
        for (const ConvexPiece& piece : bodies_.pieces_in_world(candidate.body)) {
          if (IsSeenAt(piece, z)) seen.push_back({&piece, BoundingBox(piece.vertices)});
        }
      }
      const Ray ray{origin, directions[i]};
      for (const SeenPiece& s : seen) {
        if (ray.MayMeet(s.box, nearest[i].distance)) MeetPolygon(s.piece->vertices, s.piece->model, ray, nearest[i]);
      }
    };
    const double half_width = HalfWidth(distance, candidate.radius);
    if (half_width >= kPi) {
      for (std::size_t i = 0; i < bearings.size(); ++i) meet(i);
    } else {
      const double bearing = Atan2(center.y(), center.x()) - heading;
      sorted.ForEachWithin(bearing - half_width, bearing + half_width, meet);
    }
  }

  hits.resize(bearings.size());
  for (std::size_t i = 0; i < bearings.size(); ++i) hits[i] = nearest[i].hit();
}

std::optional<RayHit> CastRay(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, const Vec2& direction,
                              double z, double max_distance, std::optional<RobotId> caster) {
  const Rectangle box = BoxOf(origin, origin + max_distance * direction);
  return RayCaster(scene, bodies, box, caster).CastRay(origin, direction, z, max_distance);
}

void CastFan(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, double heading,
             std::span<const double> bearings, double z, double max_distance, std::optional<RobotId> caster,
             std::vector<std::optional<RayHit>>& hits) {
  const Rectangle box = BoxOf(origin, origin).Inflated(max_distance);
  RayCaster(scene, bodies, box, caster).CastFan(origin, heading, bearings, z, max_distance, hits);
}

}  // namespace troupe
