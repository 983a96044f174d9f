#include "common/sensing/contact_search.h"

#include <algorithm>
#include <memory_resource>

namespace troupe {

std::vector<Touch> FindTouches(const SensedWorld& world, RobotId robot, std::span<const Vec2> outline,
                               const ZRange& z) {
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& vertex : outline) box.Extend(vertex);
  box = box.Inflated(kContactReach);
  std::vector<Touch> touches;
  const auto test = [&](const ConvexPiece& piece) {
    if (!piece.obstacle || !HasHeight(piece.z)) return;
    if (z.min == z.max ? !piece.z.Contains(z.min) : !piece.z.Overlaps(z)) return;
    const NearestPoints points = FindNearestPoints(outline, piece.vertices);
    if (points.distance > kContactReach) return;
    touches.push_back({piece.model, points, {std::max(z.min, piece.z.min), std::min(z.max, piece.z.max)}});
  };
  NearPieces near;
  world.scene.static_index().Query(box, near);
  for (const ConvexPiece* piece : near) test(*piece);
  std::pmr::vector<BodyId> bodies;
  world.bodies.Query(box, bodies);
  for (const BodyId body : bodies) {
    if (world.bodies.owner(body) == robot) continue;
    for (const ConvexPiece& piece : world.bodies.pieces_in_world(body)) test(piece);
  }
  return touches;
}

}  // namespace troupe
