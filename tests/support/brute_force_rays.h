// BruteForceRays: a ray caster without convex pieces and grids, which visits the outlines of all models.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/support/exact_prisms.h"
#include "troupe/world_state.h"

namespace troupe::test {

struct BruteForceHit {
  long double distance;  // m
  ModelId model;
};

class BruteForceRays {
 public:
  // REQUIRES: the world outlives it.
  BruteForceRays(const WorldDescription& world, const WorldState& state)
      : world_(world), bodies_(ExactPrisms(world, state, [&](ModelId id) { return IsSeen(id); }).Take()) {}

  // The hits of a ray of all outlines within `max_distance`, unsorted. REQUIRES: |direction| = 1
  std::vector<BruteForceHit> Cast(const Vec2& origin, const Vec2& direction, double z, double max_distance,
                                  std::optional<RobotId> caster) const {
    std::vector<BruteForceHit> hits;
    for (const ExactPrism& body : bodies_) {
      if (caster && world_.robot(*caster).root == body.root) continue;
      if (z < body.min_z || z >= body.max_z) continue;
      const long double distance = Distance(body, {origin.x(), origin.y()}, {direction.x(), direction.y()});
      if (distance >= 0.0L && distance <= max_distance) hits.push_back({distance, body.model});
    }
    return hits;
  }

  static BruteForceHit Nearest(const std::vector<BruteForceHit>& hits) {
    return *std::min_element(hits.begin(), hits.end(),
                             [](const BruteForceHit& a, const BruteForceHit& b) { return a.distance < b.distance; });
  }

 private:
  using Point = ExactPoint;

  bool IsSeen(ModelId id) const { return world_.model(id).ranger_return >= 0.0; }

  // Distance to the hit; 0 from inside, negative for a miss.
  static long double Distance(const ExactPrism& body, const Point& origin, const Point& direction) {
    if (body.Contains(origin)) return 0.0L;
    long double nearest = -1.0L;
    for (std::size_t i = 0; i < body.outline.size(); ++i) {
      const Point& a = body.outline[i];
      const Point& b = body.outline[(i + 1) % body.outline.size()];
      const Point edge{b.x - a.x, b.y - a.y};
      const Point to{a.x - origin.x, a.y - origin.y};
      const long double denominator = direction.x * edge.y - direction.y * edge.x;
      if (denominator == 0.0L) continue;
      const long double t = (to.x * edge.y - to.y * edge.x) / denominator;
      const long double s = (to.x * direction.y - to.y * direction.x) / denominator;
      if (t >= 0.0L && s >= 0.0L && s <= 1.0L && (nearest < 0.0L || t < nearest)) nearest = t;
    }
    return nearest;
  }

  const WorldDescription& world_;
  std::vector<ExactPrism> bodies_;
};

}  // namespace troupe::test
