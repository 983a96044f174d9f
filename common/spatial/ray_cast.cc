#include "common/spatial/ray_cast.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace troupe {
namespace {

// A ray's line.
struct Line {
  Vec2 origin;
  Vec2 direction;  // of length 1

  // False only if the ray does not hit the box before `distance`. Cheap, and never wrong by rounding.
  bool MayHit(const Rectangle& box, double distance) const {
    constexpr double kRayTolerance = 1e-8;  // m
    const Vec2 slant = direction.cwiseAbs();
    const Vec2 center(0.5 * (box.min_x + box.max_x) - origin.x(), 0.5 * (box.min_y + box.max_y) - origin.y());
    const Vec2 half(0.5 * (box.max_x - box.min_x) + kRayTolerance, 0.5 * (box.max_y - box.min_y) + kRayTolerance);
    if (std::abs(Cross(direction, center)) > half.x() * slant.y() + half.y() * slant.x()) return false;
    const double along = direction.dot(center);
    const double reach = half.dot(slant);
    return along + reach >= 0.0 && along - reach <= distance;
  }
};

// The nearest hit so far.
struct Nearest {
  double distance;  // m; the ray's length without a hit
  std::optional<ModelId> model;

  bool IsBeatenBy(double candidate, ModelId candidate_model) const {
    if (candidate != distance) return candidate < distance;
    return !model || candidate_model < *model;
  }
  std::optional<RayHit> hit() const {
    return model ? std::optional<RayHit>({.distance = distance, .model = *model}) : std::nullopt;
  }
};

// Distance along the ray's line to the edge from `before` to `here`, whose ends are on different sides of the line.
double Crossing(const Line& ray, const Vec2& before, double side_before, const Vec2& here, double side) {
  const double at_before = ray.direction.dot(before);
  return at_before + (ray.direction.dot(here) - at_before) * (side_before / (side_before - side));
}

// Distance at which the ray enters the convex polygon, 0 if it starts inside; negative without a hit. A polygon that
// ends at the ray's start is behind it.
//
// A vertex is left or right of the ray by the sign of one number that depends on nothing else, so that of two polygons
// that share a vertex at least one is hit: no ray slips through the joints between the rectangles of a wall.
double DistanceTo(std::span<const Vec2> vertices, const Line& ray) {
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
  explicit BoxLine(const Line& ray)
      : origin_(ray.origin),
        inverse_(ray.direction.array().inverse()),
        along_axis_((ray.direction.array() == 0.0).any()) {}

  // As DistanceTo. Two boxes that share a side give the same bits for it, so that no ray slips through between them.
  double DistanceTo(const Rectangle& box) const {
    Eigen::Array2d at_min = (Eigen::Array2d(box.min_x, box.min_y) - origin_) * inverse_;
    Eigen::Array2d at_max = (Eigen::Array2d(box.max_x, box.max_y) - origin_) * inverse_;
    if (along_axis_) {
      for (int i = 0; i < 2; ++i) {
        if (!std::isinf(inverse_[i])) continue;
        const double from = origin_[i];
        const bool within = i == 0 ? box.min_x <= from && from <= box.max_x : box.min_y <= from && from <= box.max_y;
        if (!within) return -1.0;
        at_min[i] = -kInfinity;
        at_max[i] = kInfinity;
      }
    }
    const double enter = at_min.min(at_max).maxCoeff();
    const double leave = at_min.max(at_max).minCoeff();
    // One jump for both conditions: which of them fails cannot be foreseen.
    return ((enter <= leave) & (leave > kTouchTolerance)) ? std::max(enter, 0.0) : -1.0;
  }
  const Eigen::Array2d& inverse() const { return inverse_; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Array2d origin_;
  Eigen::Array2d inverse_;  // 1 / direction by components
  bool along_axis_;
};

void KeepNearer(double distance, ModelId model, Nearest& nearest) {
  if (distance >= 0.0 && nearest.IsBeatenBy(distance, model)) nearest = {distance, model};
}

void HitStaticPieces(const StaticIndex& index, const Line& ray, double z, Nearest& nearest) {
  // The walk's own distances round too; the tolerance keeps hits exactly at the start of a cell.
  constexpr double kRayTolerance = 1e-8;  // m
  const BoxLine box_line(ray);
  index.WalkRay(ray.origin, ray.direction, box_line.inverse(), nearest.distance,
                [&](std::span<const std::uint32_t> pieces, double walked) {
                  if (walked > nearest.distance + kRayTolerance) return false;
                  for (std::uint32_t i : pieces) {
                    const RayPiece& piece = index.ray_map().piece(i);
                    if (piece.is_box != 0) {
                      if (piece.z.Contains(z)) KeepNearer(box_line.DistanceTo(piece.box), piece.model, nearest);
                      continue;
                    }
                    if (!ray.MayHit(piece.box, nearest.distance) || !piece.z.Contains(z)) continue;
                    KeepNearer(DistanceTo(index.ray_map().vertices(piece), ray), piece.model, nearest);
                  }
                  return true;
                });
}

// As HitStaticPieces, of one area: a piece that fills a box along the axes gives the bits of the box.
void HitAreaPieces(const PixelPieces& area, const Line& ray, double z, Nearest& nearest) {
  constexpr double kRayTolerance = 1e-8;  // m, as above
  if (!area.ray_z().Contains(z)) return;
  const BoxLine box_line(ray);
  area.WalkRay(ray.origin, ray.direction, nearest.distance, [&](const PixelRectangle& pixels, double walked) {
    if (walked > nearest.distance + kRayTolerance) return false;
    area.ForEachIn(pixels, [&](const PixelPieces::Corners4& corners) {
      const Rectangle box = BoundingBox(corners);
      if (IsBox(corners)) {
        KeepNearer(box_line.DistanceTo(box), area.model(), nearest);
      } else if (ray.MayHit(box, nearest.distance)) {
        KeepNearer(DistanceTo(corners, ray), area.model(), nearest);
      }
    });
    return true;
  });
}

// The bodies that some rays may hit, with positions relative to a place near the rays.
class NearBodies {
 public:
  // `reference`: near the rays, so that differences are exact enough wherever in the world they are; frame W. `seen`: a
  // box around the rays.
  void Find(const Scene& scene, const BodyIndex& bodies, const Vec2& reference, const Rectangle& seen,
            std::optional<RobotId> caster) {
    max_radius_ = scene.max_body_radius();
    discs_.Clear();
    ids_.clear();
    bodies.ForEachNear(seen, [&](BodyId id) {
      if (caster && bodies.owner(id) == caster) return;
      discs_.Add(bodies.X_WB(id).translation() - reference, scene.ray_shape(id).radius);
      ids_.push_back(id);
    });
  }

  double max_radius() const { return max_radius_; }

  // Calls visit(body, disc around it relative to the reference) for those that overlap the box.
  template <typename Visit>
  void ForEachIn(const DiscBox& box, Visit visit) const {
    discs_.ForEachOverlapping(box, [&](std::size_t i) { visit(ids_[i], discs_[i]); });
  }

 private:
  double max_radius_ = 0.0;
  DiscList discs_;  // around ids_
  std::vector<BodyId> ids_;
};

// Up to kLanes rays whose distances to a body are computed at once, with vector instructions in single precision and a
// margin that makes up for it.
class RayBlock {
 public:
  static constexpr std::size_t kLanes = 16;

  // `reference`: as that of the bodies.
  RayBlock(std::span<const Ray> rays, std::span<const Nearest> nearest, const Vec2& reference)
      : used_lanes_((1u << rays.size()) - 1), forward_(rays[rays.size() / 2].direction) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto set = [i](Lanes& lanes, double value) { lanes[i / kWidth][i % kWidth] = static_cast<float>(value); };
      const Ray& ray = rays[i];
      const Vec2 origin = ray.origin - reference;
      const Vec2 origin_F(forward_.dot(origin), Cross(forward_, origin));
      const Vec2 direction_F(forward_.dot(ray.direction), Cross(forward_, ray.direction));
      seen_F_.Extend(origin_F);
      seen_F_.Extend(origin_F + nearest[i].distance * direction_F);
      const double across = Cross(ray.direction, origin);
      const double start = ray.direction.dot(origin);
      set(dx_, ray.direction.x());
      set(dy_, ray.direction.y());
      set(across_, across);
      set(start_, start);
      set(length_, nearest[i].distance);
      spread_ = std::max({spread_, std::abs(across), std::abs(start), nearest[i].distance});
    }
  }

  // A box around the rays, relative to the reference. It lies along one of them, so that it is narrow if
  // they are a part of a fan. `max_radius`: no body has a larger one.
  DiscBox seen(double max_radius) const { return {seen_F_, max_radius, forward_}; }

  // Calls visit(ray, distance) for the rays that reach the disc before they end; `distance`: a lower bound.
  template <typename Visit>
  void ForEachNear(const DiscList::Disc& disc, Visit visit) const {
    constexpr float kRounding = 1e-6f;  // several times that of a float
    const auto [x, y, disc_radius] = disc;
    const float radius =
        disc_radius + kRounding * (disc_radius + std::abs(x) + std::abs(y) + 3.0f * static_cast<float>(spread_));
    Lanes along;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < kLanes / kWidth; ++k) {
      along[k] = dx_[k] * x + dy_[k] * y - start_[k];
      const Float4 aside = dx_[k] * y - dy_[k] * x - across_[k];
      // NaN is near.
      const Bits4 apart =
          (aside > radius) | (aside < -radius) | (along[k] < -radius) | (along[k] > length_[k] + radius);
      bits |= BitsOf(~apart) << (kWidth * k);
    }
    for (std::uint32_t near = bits & used_lanes_; near != 0; near &= near - 1) {
      const auto ray = static_cast<std::size_t>(std::countr_zero(near));
      visit(ray, along[ray / kWidth][ray % kWidth] - radius);
    }
  }

 private:
  static constexpr std::size_t kWidth = 4;
  using Lanes = std::array<Float4, kLanes / kWidth>;
  Lanes dx_{};  // directions
  Lanes dy_{};
  Lanes across_{};  // m, of the lines, left of the reference
  Lanes start_{};   // m, the rays' starts along their directions
  Lanes length_{};  // m
  double spread_ = 0.0;
  std::uint32_t used_lanes_;  // a bit for each lane with a ray
  Vec2 forward_;              // the x axis of a frame F at the reference
  Rectangle seen_F_ = Rectangle::Nothing();
};

// Finds the hits of rays on bodies.
class BodyHits {
 public:
  struct Lists {
    std::vector<Vec2> vertices;        // of one piece, in W
    std::vector<std::uint32_t> slice;  // in RayShape::pieces
  };

  // `lists`: whose memory is used.
  BodyHits(const Scene& scene, const BodyIndex& bodies, Lists& lists)
      : scene_(scene), bodies_(bodies), vertices_(lists.vertices), slice_(lists.slice) {}

  // Updates the ray's nearest hit by its hit on one body.
  void Update(const Ray& ray, BodyId id, Nearest& nearest) {
    const RayShape& shape = scene_.ray_shape(id);
    const Pose& X_WB = bodies_.X_WB(id);
    if (!(shape.z + X_WB.z).Contains(ray.z)) return;
    SliceAt(shape, X_WB.z, ray.z);
    Transform2 transform = bodies_.transform(id);
    Line line_L = InFrame(transform, ray);
    double z = X_WB.z;
    std::uint32_t link = 0;
    for (const std::uint32_t number : slice_) {
      const RayShape::Piece& piece = shape.pieces[number];
      if (piece.link != link) {
        link = piece.link;
        const Pose X_WL = link == 0 ? X_WB : X_WB * bodies_.X_BL(id)[link];
        transform = Transform2(X_WL);
        line_L = InFrame(transform, ray);
        z = X_WL.z;
      }
      if (piece.link != 0 && !(piece.z + z).Contains(ray.z)) continue;
      if (!line_L.MayHit(piece.box, nearest.distance)) continue;
      const double distance = DistanceToPiece(shape, piece, transform, {ray.origin, ray.direction}, line_L);
      // The model is looked up only when it may count.
      if (distance < 0.0 || distance > nearest.distance) continue;
      KeepNearer(distance, scene_.body(id).pieces[piece.number].model, nearest);
    }
  }

 private:
  static Line InFrame(const Transform2& X_WL, const Ray& ray) {
    return {X_WL.InverseTransform(ray.origin), X_WL.InverseRotate(ray.direction)};
  }

  // As DistanceTo of the piece's vertices in W, with the same bits. The edges that the ray crosses are found in the
  // frame of the link, so that only the ends of the one by which it enters have to be placed in W.
  double DistanceToPiece(const RayShape& shape, const RayShape::Piece& piece, const Transform2& X_WL, const Line& ray,
                         const Line& line_L) {
    constexpr std::uint32_t kFewVertices = 4;  // placed in W without a test
    if (piece.vertex_count > kFewVertices) {
      using Kind = RayShape::Passage::Kind;
      const RayShape::Passage passage = shape.Pass(piece, line_L.direction, Cross(line_L.direction, line_L.origin));
      if (passage.kind == Kind::kApart) return -1.0;
      if (passage.kind == Kind::kThrough) {
        const auto crossing = [&](const Line& line, std::uint32_t edge, auto place) {
          const Vec2 before = place(shape.vertices[piece.first_vertex + edge]) - line.origin;
          const Vec2 here = place(shape.vertices[piece.first_vertex + edge + 1]) - line.origin;
          return Crossing(line, before, Cross(line.direction, before), here, Cross(line.direction, here));
        };
        const double enter = crossing(ray, passage.enter, [&](const Vec2& vertex) -> Vec2 { return X_WL * vertex; });
        const double leave = crossing(line_L, passage.leave, [](const Vec2& vertex) { return vertex; });
        constexpr double kClear = 1e-3;  // m, far above the difference between the frames
        if (leave > kClear && leave > enter + kClear) return std::max(enter, 0.0);
      }
    }
    vertices_.clear();
    for (const Vec2& vertex : shape.vertices_of(piece)) vertices_.push_back(X_WL * vertex);
    return DistanceTo(vertices_, ray);
  }

  // Fills slice_: the pieces that a ray at height `z` may hit, of a body at height `z_body`. Neighbouring bodies are
  // usually alike, so the last slice is kept.
  void SliceAt(const RayShape& shape, double z_body, double z) {
    if (sliced_ == &shape && sliced_z_body_ == z_body && sliced_z_ == z) return;
    sliced_ = &shape;
    sliced_z_body_ = z_body;
    sliced_z_ = z;
    slice_.clear();
    for (std::uint32_t i = 0; i < shape.pieces.size(); ++i) {
      const RayShape::Piece& piece = shape.pieces[i];
      if (piece.link != 0 || (piece.z + z_body).Contains(z)) slice_.push_back(i);
    }
  }

  const Scene& scene_;
  const BodyIndex& bodies_;
  std::vector<Vec2>& vertices_;
  const RayShape* sliced_ = nullptr;
  double sliced_z_body_ = 0.0;
  double sliced_z_ = 0.0;
  std::vector<std::uint32_t>& slice_;
};

// Finds the hits of a block of rays on the bodies near them. Each ray is tested first against the body that begins
// first: then most others are beyond its hit.
class BlockHits {
 public:
  // Updates each ray's nearest hit.
  void Update(std::span<const Ray> rays, const Vec2& reference, const NearBodies& near, BodyHits& body_hits,
              std::span<Nearest> nearest) {
    const RayBlock block(rays, nearest, reference);
    std::array<std::uint32_t, RayBlock::kLanes> first;
    first.fill(kNone);
    pairs_.clear();
    near.ForEachIn(block.seen(near.max_radius()), [&](BodyId body, const DiscList::Disc& disc) {
      block.ForEachNear(disc, [&](std::size_t ray, float distance) {
        if (first[ray] == kNone || distance < pairs_[first[ray]].distance) {
          first[ray] = static_cast<std::uint32_t>(pairs_.size());
        }
        pairs_.push_back({distance, static_cast<std::uint32_t>(ray), body});
      });
    });
    for (std::size_t ray = 0; ray < rays.size(); ++ray) {
      if (first[ray] != kNone) body_hits.Update(rays[ray], pairs_[first[ray]].body, nearest[ray]);
    }
    for (std::uint32_t i = 0; i < pairs_.size(); ++i) {
      const Pair& pair = pairs_[i];
      if (i == first[pair.ray] || pair.distance > nearest[pair.ray].distance) continue;
      body_hits.Update(rays[pair.ray], pair.body, nearest[pair.ray]);
    }
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  struct Pair {
    float distance;  // m, the ray does not hit the body before
    std::uint32_t ray;
    BodyId body;
  };
  std::vector<Pair> pairs_;
};

// The lists of a cast, kept from cast to cast, so that a cast allocates nothing.
struct Workspace {
  std::vector<Nearest> nearest;
  NearBodies near;
  BodyHits::Lists body_hits;
  BlockHits block_hits;
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
  thread_local Workspace workspace;
  std::vector<Nearest>& nearest = workspace.nearest;
  nearest.clear();
  Rectangle seen = Rectangle::Nothing();
  for (const Ray& ray : rays) {
    Nearest& hit = nearest.emplace_back(Nearest{ray.max_distance, std::nullopt});
    HitStaticPieces(scene.static_index(), {ray.origin, ray.direction}, ray.z, hit);
    for (const PixelPieces& area : scene.static_index().areas()) {
      HitAreaPieces(area, {ray.origin, ray.direction}, ray.z, hit);
    }
    seen.Extend(ray.origin);
    seen.Extend(ray.origin + hit.distance * ray.direction);
  }

  const Vec2 reference = rays.front().origin;
  NearBodies& near = workspace.near;
  near.Find(scene, bodies, reference, seen, caster);
  BodyHits body_hits(scene, bodies, workspace.body_hits);
  for (std::size_t first = 0; first < rays.size(); first += RayBlock::kLanes) {
    const std::size_t count = std::min(RayBlock::kLanes, rays.size() - first);
    workspace.block_hits.Update(rays.subspan(first, count), reference, near, body_hits,
                                std::span(nearest).subspan(first, count));
  }

  hits.reserve(rays.size());
  for (const Nearest& found : nearest) hits.push_back(found.hit());
}

}  // namespace troupe
