#include "world-service/core/pedestrian_motion.h"

#include <algorithm>
#include <span>

namespace troupe {
namespace {

constexpr double kAllowance = 1e-9;  // m, of rounding

}  // namespace

PeopleMover::Room PeopleMover::RoomOn(PersonId id, const Vec2& from, const Vec2& to) {
  const Scene& scene = workspace_.scene;
  const double radius = view_.disc(id.index()).radius;
  const ZRange z = view_.disc(id.index()).z;
  Rectangle box = Rectangle::Nothing();
  box.Extend(from);
  box.Extend(to);
  box = box.Inflated(radius);
  const Vec2 way[2] = {from, to};
  const std::span<const Vec2> path(way, from == to ? 1 : 2);
  Room room = Room::kFree;
  // The way of the centre as a segment: the cylinder sweeps a stadium, which meets an outline that is nearer to the
  // segment than the radius.
  const auto consider = [&](std::span<const Vec2> outline, double distance) {
    if (FindNearestPoints(path, outline).distance >= distance - kAllowance) return;
    const bool is_inside = FindNearestPoints(path.first(1), outline).distance < distance - kAllowance;
    room = is_inside ? Room::kTight : std::max(room, Room::kTaken);
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
    // Robots and objects by their pieces, people by their cylinders, at their present poses.
    if (body < first_person) {
      for (const ConvexPiece& piece : workspace_.bodies.pieces_in_world(body)) consider_piece(piece);
      continue;
    }
    const std::size_t other = body.index() - first_person.index();
    if (!view_.disc(other).z.Overlaps(z)) continue;
    const Vec2 center = workspace_.next.people[other].X_WP.translation();
    consider(std::span(&center, 1), radius + view_.disc(other).radius);
  }
  return room;
}

void PeopleMover::Move(PersonId id, const PersonState& plan) {
  PersonState& person = workspace_.next.people[id.index()];
  const Pose before = person.X_WP;
  const Vec2 from = before.translation();
  const Vec2 velocity(plan.vx, plan.vy);
  person = plan;
  const BodyId body = workspace_.scene.body_of(id);
  const bool stays = plan.vx == 0.0 && plan.vy == 0.0 && plan.X_WP.heading == before.heading;
  if (stays || IsAway(plan)) return workspace_.bodies.Move(body, person.X_WP);
  for (const double part : {1.0, 0.5, 0.25, 0.0}) {
    const Vec2 to = from + part * workspace_.seconds() * velocity;
    const Room room = RoomOn(id, from, to);
    // A shorter part of the way may be free.
    if (room == Room::kTaken) continue;
    person.X_WP.x = to.x();
    person.X_WP.y = to.y();
    if (room == Room::kTight) {
      // Another body is closer than the cylinder, but not in the body itself: exactly, and without turning.
      person.X_WP.heading = before.heading;
      if (!IsFree(id, before, part * velocity)) continue;
    }
    person.vx = part * plan.vx;
    person.vy = part * plan.vy;
    break;
  }
  // The index follows at once: the next person sees this one at its new place.
  workspace_.bodies.Move(body, person.X_WP);
}

bool PeopleMover::IsFree(PersonId id, const Pose& X_WP, const Vec2& velocity) const {
  const BodyId body = workspace_.scene.body_of(id);
  const Vec2 in_P = Transform2(X_WP).InverseRotate(velocity);
  const Motion motion{.X_WF = X_WP, .twist = {in_P.x(), in_P.y(), 0.0}, .duration = workspace_.seconds()};
  // The body is where it was, and was free there.
  if (motion.IsRest()) return true;
  return !FirstContact(workspace_.scene, workspace_.bodies, MoverOf(workspace_.scene, body), motion);
}

}  // namespace troupe
