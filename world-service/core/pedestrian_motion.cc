#include "world-service/core/pedestrian_motion.h"

namespace troupe {

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
    const PersonRoom::Found room = room_.On(id, from, to);
    // A shorter part of the way may be free.
    if (room == PersonRoom::Found::kTaken) continue;
    person.X_WP.x = to.x();
    person.X_WP.y = to.y();
    if (room == PersonRoom::Found::kTight) {
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
