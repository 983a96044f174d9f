// Column casting: the bodies that a vertical half plane cuts, for sensors that look up and down. A half plane starts at
// an origin and extends in one direction; it cuts a convex prism in a rectangle, from `enter` to `leave` along the
// direction and over the prism's heights. A ray of the half plane hits the prism where it first is in the rectangle.
//
// As for rays (ray_cast.h): the bodies of the robot that looks, and of the objects that it holds, are left out, and a
// prism that ends at the origin is behind it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/vec2.h"
#include "common/geometry/z_range.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

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
  struct NearPiece {
    Vec2 center;    // m, relative to the origin, of a disc around the piece
    double radius;  // m
    const ConvexPiece* piece;
  };

  const Scene& scene_;
  Vec2 origin_;
  double reach_;
  Sight sight_;
  std::vector<NearPiece> near_;  // of moving bodies
  // By static piece: the number of the last half plane that was tested against it.
  std::vector<std::uint32_t> tested_;
  std::uint32_t number_ = 0;
};

// A ray that climbs by `slope` m for each m of horizontal distance, from height `z` at the origin of a half plane.
struct ClimbingRay {
  double z = 0.0;      // m, in W
  double slope = 0.0;  // the tangent of its elevation
};

enum class PrismFace : std::uint8_t { kSide, kTop, kUnderside, kInside };

struct ColumnHit {
  double distance = 0.0;  // m, horizontally
  ModelId model;
  PrismFace face = PrismFace::kSide;
  Vec2 normal{0.0, 0.0};  // of a kSide
};

// The horizontal distance at which the ray is first in the cut; nothing if it passes above or below.
std::optional<ColumnHit> HitOf(const ClimbingRay& ray, const ColumnCut& cut);

// The nearest hit of the ray; of cuts at the same distance the one with the lowest model id counts.
// REQUIRES: `cuts` as from ColumnCaster::Cut.
std::optional<ColumnHit> FirstHit(const ClimbingRay& ray, std::span<const ColumnCut> cuts);

}  // namespace troupe
