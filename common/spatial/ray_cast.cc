#include "common/spatial/ray_cast.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/spatial/ray_block.h"
#include "common/spatial/ray_line.h"

namespace troupe {
namespace {

void HitStaticPieces(const StaticIndex& index, const RayLine& ray, double z, const BoxLine& box_line, GridWalk& walk,
                     NearestHit& nearest) {
  // The walk's own distances round too; the tolerance keeps hits exactly at the start of a cell.
  constexpr double kRayTolerance = 1e-8;  // m
  const RayMap& map = index.ray_map();
  const std::uint8_t* const filled = map.filled();
  while (walk.Next([filled](std::size_t cell) { return filled[cell]; })) {
    if (walk.entered() > nearest.distance + kRayTolerance) return;
    const auto visit = [&](std::size_t cell) {
      if (filled[cell] == 0) return;
      for (std::uint32_t i : map.PiecesInCell(cell)) {
        const RayPiece& piece = map.piece(i);
        // Boxes are most of the pieces of maps, and have a test of their own without vertices.
        if (piece.is_box != 0) {
          if (piece.z.Contains(z)) KeepNearer(box_line.DistanceTo(piece.box), piece.model, nearest);
          continue;
        }
        if (!ray.MayHit(piece.box, nearest.distance) || !piece.z.Contains(z)) continue;
        KeepNearer(DistanceTo(map.vertices(piece), ray), piece.model, nearest);
      }
    };
    // Pieces of the second cell may be nearer than those of the first: both are read before the walk's distance is
    // compared again.
    const auto [cell, next] = walk.cells();
    visit(cell);
    if (next != cell) visit(next);
  }
}

// As HitStaticPieces, of one area: a piece that fills a box along the axes gives the bits of the box.
void HitAreaPieces(const PixelPieces& area, const RayLine& ray, double z, NearestHit& nearest) {
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

// `length_of(i)`: m, of ray i.
template <typename LengthOf>
Rectangle BoxAround(std::span<const Ray> rays, LengthOf length_of) {
  Rectangle box = Rectangle::Nothing();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    box.Extend(rays[i].origin);
    box.Extend(rays[i].origin + length_of(i) * rays[i].direction);
  }
  return box;
}

// The walks of a block of rays over the map.
struct MapWalks {
  void Start(const StaticIndex& index, std::span<const Ray> rays) {
    lines.clear();
    WalkBlock block;
    for (const Ray& ray : rays) {
      lines.emplace_back(RayLine{ray.origin, ray.direction});
      block.Add(ray.origin, ray.direction, lines.back().inverse(), ray.max_distance);
    }
    index.StartWalks(block, std::span(walks).first(rays.size()));
  }
  std::vector<BoxLine> lines;
  std::array<GridWalk, WalkBlock::kLanes> walks;
};

// Finds each ray's nearest hit on the map. All walks are prepared before the first: a ray's preparation would else wait
// for the end of the last one's walk, which no processor can predict.
void HitMap(const StaticIndex& index, std::span<const Ray> rays, MapWalks& walks, std::span<NearestHit> nearest) {
  // Short rays in the open, as in a swarm, see no piece, and then need no walk.
  const bool walk = !index.IsSurelyEmpty(BoxAround(rays, [&](std::size_t i) { return rays[i].max_distance; }));
  if (walk) walks.Start(index, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const RayLine line{rays[i].origin, rays[i].direction};
    nearest[i] = {rays[i].max_distance, std::nullopt};
    if (walk) HitStaticPieces(index, line, rays[i].z, walks.lines[i], walks.walks[i], nearest[i]);
    for (const PixelPieces& area : index.areas()) HitAreaPieces(area, line, rays[i].z, nearest[i]);
  }
}

// The bodies that some rays may hit.
struct NearBodies {
  // `reference`: near the rays; frame W. `seen`: a box around the rays.
  void Find(const Scene& scene, const BodyIndex& bodies, const Vec2& reference, const Rectangle& seen,
            std::optional<RobotId> caster) {
    discs.Clear();
    ids.clear();
    max_radius = scene.max_body_radius();
    bodies.ForEachNear(seen, [&](BodyId id) {
      // The robot itself and what it holds.
      if (caster && bodies.owner(id) == caster) return;
      discs.Add(bodies.X_WB(id).translation() - reference, scene.ray_shape(id).radius);
      ids.push_back(id);
    });
  }

  DiscList discs;  // around them, relative to the reference
  std::vector<BodyId> ids;
  double max_radius = 0.0;  // m, at least that of each
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
  void Update(const Ray& ray, BodyId id, NearestHit& nearest) {
    const RayShape& shape = scene_.ray_shape(id);
    const Pose& X_WB = bodies_.X_WB(id);
    // A body at another height: the cheapest test first.
    if (!(shape.z + X_WB.z).Contains(ray.z)) return;
    SliceAt(shape, X_WB.z, ray.z);
    Transform2 transform = bodies_.transform(id);
    RayLine line_L = InFrame(transform, ray);
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
      // An equal distance counts if the model has the lower id.
      if (distance < 0.0 || distance > nearest.distance) continue;
      KeepNearer(distance, scene_.body(id).pieces[piece.number].model, nearest);
    }
  }

 private:
  static RayLine InFrame(const Transform2& X_WL, const Ray& ray) {
    return {X_WL.InverseTransform(ray.origin), X_WL.InverseRotate(ray.direction)};
  }

  // As DistanceTo of the piece's vertices in W, with the same bits. The edges that the ray crosses are found in the
  // frame of the link, so that only the ends of the one by which it enters have to be placed in W.
  double DistanceToPiece(const RayShape& shape, const RayShape::Piece& piece, const Transform2& X_WL,
                         const RayLine& ray, const RayLine& line_L) {
    constexpr std::uint32_t kFewVertices = 4;  // placed in W without a test
    if (piece.vertex_count > kFewVertices) {
      using Kind = RayShape::Passage::Kind;
      const RayShape::Passage passage = shape.Pass(piece, line_L.direction, Cross(line_L.direction, line_L.origin));
      if (passage.kind == Kind::kApart) return -1.0;
      if (passage.kind == Kind::kThrough) {
        const auto crossing = [&](const RayLine& line, std::uint32_t edge, auto place) {
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
  // Updates each ray's nearest hit. `reference`: as that of the bodies.
  void Update(std::span<const Ray> rays, const Vec2& reference, const NearBodies& near, BodyHits& body_hits,
              std::span<NearestHit> nearest) {
    std::array<RayBlock::Part, RayBlock::kLanes> parts;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      parts[i] = {rays[i].origin - reference, rays[i].direction, nearest[i].distance};
    }
    const RayBlock block({parts.data(), rays.size()}, near.max_radius);
    block.FindTouched(near.discs, touched_);
    std::array<std::uint32_t, RayBlock::kLanes> first;
    first.fill(kNone);
    pairs_.clear();
    for (const auto& [disc, touching] : touched_) {
      for (std::uint32_t left = touching; left != 0; left &= left - 1) {
        const auto ray = static_cast<std::uint32_t>(std::countr_zero(left));
        const float distance = block.WayTo(near.discs, disc, ray);
        if (first[ray] == kNone || distance < pairs_[first[ray]].distance) {
          first[ray] = static_cast<std::uint32_t>(pairs_.size());
        }
        pairs_.push_back({distance, ray, near.ids[disc]});
      }
    }
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
  std::vector<RayBlock::Touched> touched_;
  std::vector<Pair> pairs_;
};

// The lists of a cast, kept from cast to cast, so that a cast allocates nothing.
struct Workspace {
  std::vector<NearestHit> nearest;
  MapWalks walks;
  NearBodies near;
  BodyHits::Lists body_hits;
  BlockHits block_hits;
};

// Calls visit(first, count) for blocks of `size` rays.
template <typename Visit>
void ForEachBlock(std::size_t size, Visit visit) {
  for (std::size_t first = 0; first < size; first += RayBlock::kLanes) {
    visit(first, std::min(RayBlock::kLanes, size - first));
  }
}

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
  // A reference to it, because each access by name would look for the thread's copy again.
  thread_local Workspace kept;
  Workspace& workspace = kept;
  workspace.nearest.resize(rays.size());
  const std::span<NearestHit> nearest(workspace.nearest);
  ForEachBlock(rays.size(), [&](std::size_t first, std::size_t count) {
    HitMap(scene.static_index(), rays.subspan(first, count), workspace.walks, nearest.subspan(first, count));
  });
  // The map first: its hits shorten the rays, so that fewer bodies are near them.
  const Rectangle seen = BoxAround(rays, [&](std::size_t i) { return nearest[i].distance; });
  const Vec2 reference = rays.front().origin;
  workspace.near.Find(scene, bodies, reference, seen, caster);
  if (!workspace.near.ids.empty()) {
    BodyHits body_hits(scene, bodies, workspace.body_hits);
    ForEachBlock(rays.size(), [&](std::size_t first, std::size_t count) {
      workspace.block_hits.Update(rays.subspan(first, count), reference, workspace.near, body_hits,
                                  nearest.subspan(first, count));
    });
  }

  hits.reserve(rays.size());
  for (const NearestHit& found : nearest) hits.push_back(found.hit());
}

}  // namespace troupe
