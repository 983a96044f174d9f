#include "common/spatial/ray_cast.h"

#include <algorithm>
#include <array>
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

// The same with a model that is looked up only when it may count.
template <typename ModelOf>
void MeetPolygonOf(std::span<const Vec2> vertices, ModelOf model_of, const Ray& ray, Nearest& nearest) {
  const double distance = DistanceTo(vertices, ray);
  if (distance >= 0.0 && distance <= nearest.distance) Meet(distance, model_of(), nearest);
}

Rectangle BoxAround(std::span<const Vec2> points) {
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& point : points) box.Extend(point);
  return box;
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

}  // namespace

RayCaster::RayCaster(const Scene& scene, const BodyIndex& bodies, const Rectangle& box, std::optional<RobotId> caster)
    : scene_(scene), bodies_(bodies) {
  std::vector<BodyId> near;
  bodies.Query(box, near);
  candidates_.reserve(near.size());
  for (BodyId id : near) {
    if (caster && bodies.owner(id) == caster) continue;
    const RayShape& shape = scene.ray_shape(id);
    if (shape.is_empty) continue;
    const Pose& X_WB = bodies.X_WB(id);
    candidates_.push_back({id, &shape, X_WB.translation(), shape.z + X_WB.z});
  }
}

std::span<const RayCaster::PlacedPiece> RayCaster::Place(Candidate& candidate, double z) const {
  if (candidate.placed_for != z) {
    const RayShape& shape = *candidate.shape;
    const Pose& X_WB = bodies_.X_WB(candidate.body);
    Pose X_WL = X_WB;
    Transform2 transform(X_WL);
    std::uint32_t link = 0;
    candidate.first_piece = static_cast<std::uint32_t>(pieces_.size());
    for (const RayShape::Piece& piece : shape.pieces) {
      if (piece.link != link) {
        link = piece.link;
        X_WL = link == 0 ? X_WB : X_WB * bodies_.X_BL(candidate.body)[link];
        transform = Transform2(X_WL);
      }
      if (!(piece.z + X_WL.z).Contains(z)) continue;
      const auto first = static_cast<std::uint32_t>(vertices_.size());
      pieces_.push_back({.number = piece.number, .first_vertex = first, .vertex_count = piece.vertex_count});
      for (std::uint32_t v = 0; v < piece.vertex_count; ++v) {
        vertices_.push_back(transform * shape.vertices[piece.first_vertex + v]);
      }
    }
    candidate.piece_count = static_cast<std::uint32_t>(pieces_.size()) - candidate.first_piece;
    candidate.placed_for = z;
  }
  return {pieces_.data() + candidate.first_piece, candidate.piece_count};
}

std::optional<RayHit> RayCaster::CastRay(const Vec2& origin, const Vec2& direction, double z,
                                         double max_distance) const {
  const Ray ray{origin, direction};
  Nearest nearest{max_distance, std::nullopt};
  MeetStandingPieces(scene_.static_index(), ray, z, nearest);
  for (Candidate& candidate : candidates_) {
    const double radius = candidate.shape->radius;
    const Vec2 center = candidate.center - origin;
    if (std::abs(Cross(direction, center)) > radius) continue;
    const double along = direction.dot(center);
    if (along < -radius || along > nearest.distance + radius) continue;
    if (!candidate.z.Contains(z)) continue;
    for (const PlacedPiece& piece : Place(candidate, z)) {
      MeetPolygonOf(
          VerticesOf(piece), [&] { return ModelOf(candidate, piece); }, ray, nearest);
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
  // The pieces of a candidate that are seen, and the boxes around them.
  std::vector<std::pair<const PlacedPiece*, Rectangle>> seen;
  for (Candidate& candidate : candidates_) {
    const double radius = candidate.shape->radius;
    const Vec2 center = candidate.center - origin;
    const double distance = std::sqrt(center.squaredNorm());
    if (distance - radius > farthest || !candidate.z.Contains(z)) continue;
    seen.clear();
    const auto meet = [&](std::size_t i) {
      if (distance - radius > nearest[i].distance) return;
      if (seen.empty()) {
        for (const PlacedPiece& piece : Place(candidate, z)) seen.emplace_back(&piece, BoxAround(VerticesOf(piece)));
      }
      const Ray ray{origin, directions[i]};
      for (const auto& [piece, box] : seen) {
        if (!ray.MayMeet(box, nearest[i].distance)) continue;
        MeetPolygonOf(
            VerticesOf(*piece), [&, found = piece] { return ModelOf(candidate, *found); }, ray, nearest[i]);
      }
    };
    const double half_width = HalfWidth(distance, radius);
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
  const Rectangle box = BoxAround(std::array{origin, Vec2(origin + max_distance * direction)});
  return RayCaster(scene, bodies, box, caster).CastRay(origin, direction, z, max_distance);
}

void CastFan(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, double heading,
             std::span<const double> bearings, double z, double max_distance, std::optional<RobotId> caster,
             std::vector<std::optional<RayHit>>& hits) {
  const Rectangle box = BoxAround(std::array{origin}).Inflated(max_distance);
  RayCaster(scene, bodies, box, caster).CastFan(origin, heading, bearings, z, max_distance, hits);
}

}  // namespace troupe
