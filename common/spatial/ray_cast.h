// Ray casting: exact distances to the first piece that a ray meets in a horizontal plane.
//
// A ray at height z sees the pieces whose z range contains z and whose ranger_return is not negative, except those of
// the robot that casts it and of what that robot holds. A ray that starts inside such a piece meets it at distance 0.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/base/ids.h"
#include "common/geometry/vec2.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

namespace troupe {

struct RayHit {
  double distance = 0.0;  // m, 0 <= distance <= max_distance
  ModelId model;          // what was met
};

// Casts many rays near each other: finds the bodies that they may meet once for all, and places their pieces in the
// world when a ray comes near. Not safe to share between threads: casting fills a cache.
class RayCaster {
 public:
  // For rays that stay within `box`. `caster`: whose own pieces are not seen. Good until a body moves.
  RayCaster(const Scene& scene, const BodyIndex& bodies, const Rectangle& box, std::optional<RobotId> caster);

  // REQUIRES: direction has length 1; max_distance >= 0 and finite. Of pieces at the same distance the one with the
  // lowest model id counts.
  std::optional<RayHit> CastRay(const Vec2& origin, const Vec2& direction, double z, double max_distance) const;

  // A fan of rays from one point: ray i leaves at heading + bearings[i] (radians, any order). The same as a CastRay for
  // each, found together. `hits` gets one entry for each bearing.
  void CastFan(const Vec2& origin, double heading, std::span<const double> bearings, double z, double max_distance,
               std::vector<std::optional<RayHit>>& hits) const;

 private:
  // A body that rays may meet.
  struct Candidate {
    BodyId body;
    const RayShape* shape;
    Vec2 center;  // m, in W
    ZRange z;     // m, in W
    // In pieces_: those that are seen at a height, once they are placed.
    std::optional<double> placed_for = {};
    std::uint32_t first_piece = 0;
    std::uint32_t piece_count = 0;
  };
  // A piece of a candidate, in W.
  struct PlacedPiece {
    std::uint32_t number;  // in Body::pieces
    std::uint32_t first_vertex;
    std::uint32_t vertex_count;
  };
  // The pieces that are seen at height z.
  std::span<const PlacedPiece> Place(Candidate& candidate, double z) const;
  std::span<const Vec2> VerticesOf(const PlacedPiece& piece) const {
    return {vertices_.data() + piece.first_vertex, piece.vertex_count};
  }
  ModelId ModelOf(const Candidate& candidate, const PlacedPiece& piece) const {
    return scene_.body(candidate.body).pieces[piece.number].model;
  }

  const Scene& scene_;
  const BodyIndex& bodies_;
  mutable std::vector<Candidate> candidates_;
  mutable std::vector<PlacedPiece> pieces_;
  mutable std::vector<Vec2> vertices_;
};

// One ray, or one fan, by itself.
std::optional<RayHit> CastRay(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, const Vec2& direction,
                              double z, double max_distance, std::optional<RobotId> caster);
void CastFan(const Scene& scene, const BodyIndex& bodies, const Vec2& origin, double heading,
             std::span<const double> bearings, double z, double max_distance, std::optional<RobotId> caster,
             std::vector<std::optional<RayHit>>& hits);

}  // namespace troupe
