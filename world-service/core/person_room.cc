#include "world-service/core/person_room.h"

#include <algorithm>
#include <span>

#include "common/spatial/walk_portals.h"

namespace troupe {
namespace {

constexpr double kAllowance = 1e-9;  // m, of rounding

}  // namespace

// None of one that is removed.
ZRange PersonRoom::HeightsOf(PersonId id) const {
  const Scene& scene = workspace_.scene;
  if (scene.world().model(scene.world().person(id).root).removed) return {};
  return scene.body(scene.body_of(id)).z + workspace_.next.people[id.index()].X_WP.z;
}

PersonRoom::Found PersonRoom::On(PersonId id, const Vec2& from, const Vec2& to) {
  const Scene& scene = workspace_.scene;
  const double radius = RadiusOf(scene, id);
  const ZRange z = HeightsOf(id);
  Rectangle box = Rectangle::Nothing();
  box.Extend(from);
  box.Extend(to);
  box = box.Inflated(radius);
  const Vec2 way[2] = {from, to};
  const std::span<const Vec2> path(way, from == to ? 1 : 2);
  Found found = Found::kFree;
  // The way of the centre as a segment: the cylinder sweeps a stadium, which meets an outline that is nearer to the
  // segment than the radius.
  const auto consider = [&](std::span<const Vec2> outline, double distance) {
    if (FindNearestPoints(path, outline).distance >= distance - kAllowance) return;
    const bool is_inside = FindNearestPoints(path.first(1), outline).distance < distance - kAllowance;
    found = is_inside ? Found::kTight : std::max(found, Found::kTaken);
  };
  const auto consider_piece = [&](const ConvexPiece& piece) {
    if (piece.obstacle && piece.z.Overlaps(z)) consider(piece.vertices, radius);
  };
  scene.static_index().Query(box, static_pieces_);
  for (const ConvexPiece* piece : static_pieces_) consider_piece(*piece);
  bodies_.clear();
  workspace_.bodies.Query(box, bodies_);
  const BodyId first_person = scene.body_of(PersonId(0));
  for (const BodyId body : bodies_) {
    if (body == scene.body_of(id)) continue;
    // Robots and objects by their pieces, people by their cylinders.
    if (body < first_person) {
      for (const ConvexPiece& piece : workspace_.bodies.pieces_in_world(body)) consider_piece(piece);
      continue;
    }
    const PersonId other(body.index() - first_person.index());
    if (!HeightsOf(other).Overlaps(z)) continue;
    const Vec2 center = workspace_.next.people[other.index()].X_WP.translation();
    consider(std::span(&center, 1), radius + RadiusOf(scene, other));
  }
  return found;
}

}  // namespace troupe
