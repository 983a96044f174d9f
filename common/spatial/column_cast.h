// Column casting: the bodies that a vertical half plane cuts, for sensors that look up and down. A half plane starts at
// an origin and extends in one direction; it cuts a convex prism in a rectangle, from `enter` to `leave` along the
// direction and over the prism's heights. A ray of the half plane hits the prism where it first is in the rectangle.
//
// As for rays (ray_cast.h): the bodies of the robot that looks, and of the objects that it holds, are left out, and a
// prism that ends at the origin is behind it.
//
// Two-dimensional problems in place of one in three dimensions: first the half plane against the footprints, once for
// all rays of a column, then each ray of the column against rectangles. A camera of 640 x 480 pixels needs 640 half
// planes, not 307,200 rays.
//
// Cost of a half plane: the cells of the static index that it passes, and the bodies whose discs it cuts. A caster
// keeps the pieces of a body from its first cut on, for all directions.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/vec2.h"
#include "troupe/z_range.h"

namespace troupe {

// The part of a prism in a half plane.
struct ColumnCut {
  double enter = 0.0;  // m from the origin, horizontally; 0 if it starts inside
  double leave = 0.0;
  ZRange z;  // m, in W
  ModelId model;
  Vec2 normal{0.0, 0.0};  // outwards, of length 1, of the side by which it enters
  bool operator==(const ColumnCut&) const = default;
};

enum class Sight : std::uint8_t {
  kRangers,  // bodies with a ranger_return of at least 0
  kBodies,   // all bodies
};

// The half planes from one origin. Prepares the bodies near it once, for many directions.
//
// Threads: one at a time. The scene and the bodies must outlive it and stay as they are.
class ColumnCaster {
 public:
  // `reach`: m, horizontally: nothing beyond is found. `viewer`: the robot that looks.
  ColumnCaster(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, double reach,
               std::optional<RobotId> viewer, Sight sight);

  // Replaces `cuts` by all that the half plane cuts within the reach and the heights `z`, in the order of `enter`, then
  // of models. REQUIRES: |direction| = 1
  void Cut(const Vec2& direction, const ZRange& z, std::vector<ColumnCut>& cuts) { Cut(direction, z, reach_, cuts); }
  // The same within `length` m. REQUIRES: length <= reach
  void Cut(const Vec2& direction, const ZRange& z, double length, std::vector<ColumnCut>& cuts);

 private:
  // m, the center relative to the origin.
  struct Disc {
    Vec2 center;
    double radius;
  };
  struct NearPiece {
    Disc disc;  // around it
    const ConvexPiece* piece;
  };
  struct NearBody {
    BodyId id;
    Disc disc;  // around all its pieces
    // Its visible pieces, in pieces_, once a half plane has cut the disc.
    std::optional<std::size_t> first_piece;
    std::size_t piece_count = 0;
  };

  std::span<const NearPiece> PiecesOf(NearBody& near);

  const Scene& scene_;
  const BodyIndex& bodies_;
  Vec2 origin_;
  double reach_;
  Sight sight_;
  std::vector<NearBody> near_;
  std::vector<NearPiece> pieces_;
  // For each static piece, the number of the last half plane that was tested against it: pieces reach over cells, and
  // each is to be cut once.
  std::vector<std::uint32_t> tested_;
  std::uint32_t number_ = 0;
};

// A ray that climbs by `slope` m for each m of horizontal distance, from height `z` at the origin of a half plane.
struct ClimbingRay {
  double z = 0.0;      // m, in W
  double slope = 0.0;  // the tangent of its elevation
};

enum class PrismFace : std::uint8_t { kSide, kTop, kUnderside, kInside };

struct CutHit {
  double distance = 0.0;  // m, horizontally
  PrismFace face = PrismFace::kSide;
};

// The place at which the ray is first in the cut; nothing if it passes above or below.
inline std::optional<CutHit> HitOf(const ClimbingRay& ray, const ColumnCut& cut) {
  const double z_enter = ray.z + ray.slope * cut.enter;
  if (cut.z.Contains(z_enter)) return CutHit{cut.enter, cut.enter > 0.0 ? PrismFace::kSide : PrismFace::kInside};
  const bool from_above = z_enter >= cut.z.max;
  if (from_above ? ray.slope >= 0.0 : ray.slope <= 0.0) return std::nullopt;
  const double distance = ((from_above ? cut.z.max : cut.z.min) - ray.z) / ray.slope;
  if (distance > cut.leave) return std::nullopt;
  // Not before the cut, where rounding may place a hit on an edge.
  return CutHit{std::max(distance, cut.enter), from_above ? PrismFace::kTop : PrismFace::kUnderside};
}

struct ColumnHit {
  double distance = 0.0;  // m, horizontally
  ModelId model;
  PrismFace face = PrismFace::kSide;
  Vec2 normal{0.0, 0.0};  // of a kSide
};

// The nearest hit of the ray; of cuts at the same distance the lowest model id counts.
// REQUIRES: `cuts` as from ColumnCaster::Cut.
std::optional<ColumnHit> FirstHit(const ClimbingRay& ray, std::span<const ColumnCut> cuts);

}  // namespace troupe
