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
  Vec2 slant;  // |direction| by components

  Ray(const Vec2& from, const Vec2& towards) : origin(from), direction(towards), slant(towards.cwiseAbs()) {}

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

void MeetPolygon(std::span<const Vec2> vertices, ModelId model, const Ray& ray, Nearest& nearest) {
  const double distance = DistanceTo(vertices, ray);
  if (distance >= 0.0 && nearest.IsBeatenBy(distance, model)) nearest = {distance, model};
}

void MeetStandingPieces(const StaticIndex& index, const Ray& ray, double z, Nearest& nearest) {
  // The walk's own distances round too; a hair more keeps what is met exactly where a cell begins.
  constexpr double kHair = 1e-8;  // m
  index.WalkRay(ray.origin, ray.direction, nearest.distance, [&](std::span<const std::uint32_t> pieces, double walked) {
    if (walked > nearest.distance + kHair) return false;
    for (std::uint32_t i : pieces) {
      const StaticIndex::RayPiece& piece = index.ray_piece(i);
      if (!ray.MayMeet(piece.box, nearest.distance) || !piece.z.Contains(z)) continue;
      MeetPolygon(index.vertices(piece), piece.model, ray, nearest);
    }
    return true;
  });
}

// A body that rays at some height from some point may meet.
struct Candidate {
  Vec2 center;      // relative to the rays' origin, m
  double distance;  // of the centre, m
  double radius;    // m, a hair more than the body's
};

// The bodies near `box` that reach into the height z.
template <typename Visit>
void ForEachCandidate(const Scene& scene, const BodyIndex& bodies, const Rectangle& box, const Vec2& origin, double z,
                      std::optional<RobotId> caster, Visit visit) {
  std::vector<BodyId> near;
  bodies.Query(box, near);
  for (BodyId id : near) {
    if (caster && bodies.owner(id) == caster) continue;
    const Body& body = scene.body(id);
    const Pose& X_WB = bodies.X_WB(id);
    if (body.pieces.empty() || !(body.z + X_WB.z).Contains(z)) continue;
    const Vec2 center = X_WB.translation() - origin;
    visit(id, Candidate{center, std::sqrt(center.squaredNorm()), body.radius * (1.0 + 1e-9) + 1e-9});
  }
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

// The angles under which the candidate is seen from the origin: centre +- half width. A half width of pi: all around.
double HalfWidth(const Candidate& candidate) {
  if (candidate.distance <= candidate.radius) return kPi;
  return Atan2(candidate.radius,
               std::sqrt((candidate.distance - candidate.radius) * (candidate.distance + candidate.radius)));
}

}  // namespace

std::optional<RayHit> CastRay(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, const Vec2& direction,
                              double z, double max_distance, std::optional<RobotId> caster) {
  const Ray ray{origin, direction};
  Nearest nearest{max_distance, std::nullopt};
  MeetStandingPieces(scene.static_index(), ray, z, nearest);

  Rectangle box = Rectangle::Nothing();
  box.Extend(origin);
  box.Extend(Vec2(origin + nearest.distance * direction));
  ForEachCandidate(scene, bodies, box, origin, z, caster, [&](BodyId body, const Candidate& candidate) {
    if (std::abs(Cross(direction, candidate.center)) > candidate.radius) return;
    for (const ConvexPiece& piece : bodies.pieces_in_world(body)) {
      if (IsSeenAt(piece, z)) MeetPolygon(piece.vertices, piece.model, ray, nearest);
    }
  });
  return nearest.hit();
}

void CastFan(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, double heading,
             std::span<const double> bearings, double z, double max_distance, std::optional<RobotId> caster,
             std::vector<std::optional<RayHit>>& hits) {
  std::vector<Vec2> directions(bearings.size());
  std::vector<Nearest> nearest(bearings.size(), {max_distance, std::nullopt});
  double farthest = 0.0;
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    directions[i] = DirectionOf(heading + bearings[i]);
    MeetStandingPieces(scene.static_index(), {origin, directions[i]}, z, nearest[i]);
    farthest = std::max(farthest, nearest[i].distance);
  }

  const SortedBearings sorted(bearings);
  const Rectangle box = Rectangle{origin.x(), origin.y(), origin.x(), origin.y()}.Inflated(farthest);
  std::vector<SeenPiece> seen;
  ForEachCandidate(scene, bodies, box, origin, z, caster, [&](BodyId body, const Candidate& candidate) {
    if (candidate.distance - candidate.radius > farthest) return;
    seen.clear();
    const auto meet = [&](std::size_t i) {
      if (candidate.distance - candidate.radius > nearest[i].distance) return;
      if (seen.empty()) {
        for (const ConvexPiece& piece : bodies.pieces_in_world(body)) {
          if (IsSeenAt(piece, z)) seen.push_back({&piece, BoundingBox(piece.vertices)});
        }
      }
      const Ray ray{origin, directions[i]};
      for (const SeenPiece& s : seen) {
        if (ray.MayMeet(s.box, nearest[i].distance)) MeetPolygon(s.piece->vertices, s.piece->model, ray, nearest[i]);
      }
    };
    const double half_width = HalfWidth(candidate);
    if (half_width >= kPi) {
      for (std::size_t i = 0; i < bearings.size(); ++i) meet(i);
    } else {
      const double center = Atan2(candidate.center.y(), candidate.center.x()) - heading;
      sorted.ForEachWithin(center - half_width, center + half_width, meet);
    }
  });

  hits.resize(bearings.size());
  for (std::size_t i = 0; i < bearings.size(); ++i) hits[i] = nearest[i].hit();
}

}  // namespace troupe
