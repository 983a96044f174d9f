// Ray casting: exact distances to the first piece that a ray hits in a horizontal plane.
//
// A ray at height z sees the pieces whose z range contains z and whose ranger_return is not negative, except those of
// the robot that casts it and of the objects that it holds. A ray that starts inside such a piece hits it at distance
// 0. Of pieces at the same distance the lowest model id counts.
//
// Distances are exact up to the rounding of one division: no steps, no cells, so that two processes with one state
// measure the same bits, and a scan through a wall's joint has no gap. Cost of a ray: the cells of the static index up
// to its hit, and the bodies near it; the rays of a scanner share the search for bodies.
//
// Threads: any number, each with a BodyIndex of its own; a cast keeps its lists in memory of its thread.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/vec2.h"

namespace troupe {

struct Ray {
  Vec2 origin;          // m, in W
  Vec2 direction;       // of length 1
  double z;             // m, in W
  double max_distance;  // m, finite and not negative
};

struct RayHit {
  double distance = 0.0;  // m, 0 <= distance <= max_distance
  ModelId model;          // the hit model
};

// The nearest hit within ray.max_distance. `caster`: the robot whose own pieces are not seen. REQUIRES: |direction| = 1
std::optional<RayHit> CastRay(const Scene& scene, const BodyIndex& bodies, const Ray& ray,
                              std::optional<RobotId> caster);

// The hits of several rays that start near each other, as the rays of a sonar ring or a scanner, found together:
// quickest if neighbours in `rays` are neighbours in space. `hits` is replaced by one entry for each ray; its memory is
// reused.
void CastRays(const Scene& scene, const BodyIndex& bodies, std::span<const Ray> rays, std::optional<RobotId> caster,
              std::vector<std::optional<RayHit>>& hits);

}  // namespace troupe
