#include "common/spatial/ray_cast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "common/base/deterministic_math.h"

namespace troupe {
namespace {

// A ray's line, prepared for meeting many things.
struct Line {
  Vec2 origin;
  Vec2 direction;
  Vec2 slant;    // |direction| by components
  Vec2 inverse;  // 1 / direction by components

  Line(const Vec2& from, const Vec2& towards)
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
double DistanceTo(std::span<const Vec2> vertices, const Line& ray) {
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
double DistanceTo(const Rectangle& box, const Line& ray) {
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

void TakeIfNearer(double distance, ModelId model, Nearest& nearest) {
  if (distance >= 0.0 && nearest.IsBeatenBy(distance, model)) nearest = {distance, model};
}

void MeetStandingPieces(const StaticIndex& index, const Line& ray, double z, Nearest& nearest) {
  // The walk's own distances round too; a hair more keeps what is met exactly where a cell begins.
  constexpr double kHair = 1e-8;  // m
  index.WalkRay(ray.origin, ray.direction, ray.inverse, nearest.distance,
                [&](std::span<const std::uint32_t> pieces, double walked) {
                  if (walked > nearest.distance + kHair) return false;
                  for (std::uint32_t i : pieces) {
                    const StaticIndex::RayPiece& piece = index.ray_piece(i);
                    if (piece.is_box) {
                      if (piece.z.Contains(z)) TakeIfNearer(DistanceTo(piece.box, ray), piece.model, nearest);
                      continue;
                    }
                    if (!ray.MayMeet(piece.box, nearest.distance) || !piece.z.Contains(z)) continue;
                    TakeIfNearer(DistanceTo(index.vertices(piece), ray), piece.model, nearest);
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

// Which of some rays pass a disc, worked out for all of them at once.
class RayBundle {
 public:
  explicit RayBundle(std::span<const Ray> rays) : reference_(rays.front().origin) {
    const auto count = static_cast<Eigen::Index>(rays.size());
    for (Eigen::ArrayXd* column : {&dx_, &dy_, &across_, &gap_}) column->resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Ray& ray = rays[static_cast<std::size_t>(i)];
      dx_[i] = ray.direction.x();
      dy_[i] = ray.direction.y();
      across_[i] = Cross(ray.direction, ray.origin - reference_);
    }
  }

  // Calls visit(ray) for those whose lines pass it. Never wrong by rounding if the radius has a margin of 1e-9 m.
  template <typename Visit>
  void ForEachNear(const Vec2& center, double radius, Visit visit) {
    const Vec2 c = center - reference_;
    gap_ = (dx_ * c.y() - dy_ * c.x() - across_).abs();
    for (Eigen::Index i = 0; i < gap_.size(); ++i) {
      if (gap_[i] <= radius) visit(static_cast<std::size_t>(i));
    }
  }

 private:
  Vec2 reference_;  // near the rays, so that differences are exact enough wherever in the world they are
  Eigen::ArrayXd dx_, dy_, across_, gap_;
};

// A body that rays may meet: its pieces at the height of the rays, placed in W when the first one comes near.
class PlacedBody {
 public:
  PlacedBody(const Scene& scene, const BodyIndex& bodies) : scene_(scene), bodies_(bodies) {}

  void Take(BodyId body) {
    body_ = body;
    shape_ = &scene_.ray_shape(body);
    X_WB_ = &bodies_.X_WB(body);
    height_.reset();
  }
  Vec2 center() const { return X_WB_->translation(); }
  double radius() const { return shape_->radius; }

  void Meet(const Line& ray, double z, Nearest& nearest) {
    PlaceAt(z);
    for (const Piece& piece : pieces_) MeetPiece(piece, ray, nearest);
  }
  // The same, for many rays: looks at the box around a piece first.
  void MeetInBoxes(const Line& ray, double z, Nearest& nearest) {
    PlaceAt(z);
    if (boxes_.empty()) {
      for (const Piece& piece : pieces_) {
        Rectangle& box = boxes_.emplace_back(Rectangle::Nothing());
        for (const Vec2& vertex : VerticesOf(piece)) box.Extend(vertex);
      }
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (ray.MayMeet(boxes_[i], nearest.distance)) MeetPiece(pieces_[i], ray, nearest);
    }
  }

 private:
  struct Piece {
    std::uint32_t number;  // in Body::pieces
    std::uint32_t first_vertex;
    std::uint32_t vertex_count;
  };

  std::span<const Vec2> VerticesOf(const Piece& piece) const {
    return {vertices_.data() + piece.first_vertex, piece.vertex_count};
  }

  void MeetPiece(const Piece& piece, const Line& ray, Nearest& nearest) const {
    const double distance = DistanceTo(VerticesOf(piece), ray);
    // The model is looked up only when it may count.
    if (distance < 0.0 || distance > nearest.distance) return;
    TakeIfNearer(distance, scene_.body(body_).pieces[piece.number].model, nearest);
  }

  void PlaceAt(double z) {
    if (height_ == z) return;
    height_ = z;
    pieces_.clear();
    vertices_.clear();
    boxes_.clear();
    if (!(shape_->z + X_WB_->z).Contains(z)) return;
    Pose X_WL = *X_WB_;
    Transform2 transform(X_WL);
    std::uint32_t link = 0;
    for (const RayShape::Piece& piece : shape_->pieces) {
      if (piece.link != link) {
        link = piece.link;
        X_WL = link == 0 ? *X_WB_ : *X_WB_ * bodies_.X_BL(body_)[link];
        transform = Transform2(X_WL);
      }
      if (!(piece.z + X_WL.z).Contains(z)) continue;
      pieces_.push_back({piece.number, static_cast<std::uint32_t>(vertices_.size()), piece.vertex_count});
      for (std::uint32_t v = 0; v < piece.vertex_count; ++v) {
        vertices_.push_back(transform * shape_->vertices[piece.first_vertex + v]);
      }
    }
  }

  const Scene& scene_;
  const BodyIndex& bodies_;
  BodyId body_;
  const RayShape* shape_ = nullptr;
  const Pose* X_WB_ = nullptr;
  std::optional<double> height_;  // for which the pieces are placed
  std::vector<Piece> pieces_;
  std::vector<Vec2> vertices_;
  std::vector<Rectangle> boxes_;  // around the pieces, once a fan asks
};

}  // namespace

std::optional<RayHit> CastRay(const Scene& scene, const BodyIndex& bodies, const Ray& ray,
                              std::optional<RobotId> caster) {
  std::vector<std::optional<RayHit>> hits;
  CastRays(scene, bodies, {&ray, 1}, caster, hits);
  return hits.front();
}

void CastRays(const Scene& scene, const BodyIndex& bodies, std::span<const Ray> rays, std::optional<RobotId> caster,
              std::vector<std::optional<RayHit>>& hits) {
  hits.clear();
  if (rays.empty()) return;
  hits.reserve(rays.size());
  std::vector<Line> lines;
  std::vector<Nearest> nearest;
  lines.reserve(rays.size());
  nearest.reserve(rays.size());
  Rectangle seen = Rectangle::Nothing();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    lines.emplace_back(ray.origin, ray.direction);
    nearest.push_back({ray.max_distance, std::nullopt});
    MeetStandingPieces(scene.static_index(), lines[i], ray.z, nearest[i]);
    seen.Extend(ray.origin);
    seen.Extend(ray.origin + nearest[i].distance * ray.direction);
  }

  RayBundle bundle(rays);
  PlacedBody placed(scene, bodies);
  bodies.ForEachNear(seen, [&](BodyId id) {
    if (caster && bodies.owner(id) == caster) return;
    placed.Take(id);
    bundle.ForEachNear(placed.center(), placed.radius(), [&](std::size_t i) {
      const double along = rays[i].direction.dot(placed.center() - rays[i].origin);
      if (along < -placed.radius() || along > nearest[i].distance + placed.radius()) return;
      placed.Meet(lines[i], rays[i].z, nearest[i]);
    });
  });

  for (const Nearest& meeting : nearest) hits.push_back(meeting.hit());
}

void CastFan(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, double heading,
             std::span<const double> bearings, double z, double max_distance, std::optional<RobotId> caster,
             std::vector<std::optional<RayHit>>& hits) {
  std::vector<Line> lines;
  std::vector<Nearest> nearest;
  lines.reserve(bearings.size());
  nearest.reserve(bearings.size());
  double farthest = 0.0;
  for (const double bearing : bearings) {
    const Line& line = lines.emplace_back(origin, DirectionOf(heading + bearing));
    Nearest& meeting = nearest.emplace_back(Nearest{max_distance, std::nullopt});
    MeetStandingPieces(scene.static_index(), line, z, meeting);
    farthest = std::max(farthest, meeting.distance);
  }

  const SortedBearings sorted(bearings);
  PlacedBody placed(scene, bodies);
  Rectangle seen = Rectangle::Nothing();
  seen.Extend(origin);
  bodies.ForEachNear(seen.Inflated(farthest), [&](BodyId id) {
    if (caster && bodies.owner(id) == caster) return;
    placed.Take(id);
    const Vec2 center = placed.center() - origin;
    const double distance = std::sqrt(center.squaredNorm());
    if (distance - placed.radius() > farthest) return;
    const auto meet = [&](std::size_t i) {
      if (distance - placed.radius() <= nearest[i].distance) placed.MeetInBoxes(lines[i], z, nearest[i]);
    };
    const double half_width = HalfWidth(distance, placed.radius());
    if (half_width >= kPi) {
      for (std::size_t i = 0; i < bearings.size(); ++i) meet(i);
    } else {
      const double bearing = Atan2(center.y(), center.x()) - heading;
      sorted.ForEachWithin(bearing - half_width, bearing + half_width, meet);
    }
  });

  hits.resize(bearings.size());
  for (std::size_t i = 0; i < bearings.size(); ++i) hits[i] = nearest[i].hit();
}

}  // namespace troupe
