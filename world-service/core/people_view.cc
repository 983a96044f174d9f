#include "world-service/core/people_view.h"

#include <algorithm>
#include <optional>

#include "troupe/deterministic_math.h"

namespace troupe {

namespace {

Vec2 HeadingOf(const PersonState& state) {
  if (state.dwell_ticks > 0) return {0.0, 0.0};  // it waits
  const SinCosResult direction = SinCos(state.X_WP.heading);
  return {direction.cos, direction.sin};
}

}  // namespace

PeopleView::PeopleView(const StepWorkspace& workspace)
    : workspace_(workspace), discs_of_people_(workspace.next.people.size()) {
  AddPeople();
  AddBodies();
  walkers_.Fill(discs_, [](const Disc& disc) { return !disc.is_object(); });
  objects_.Fill(discs_, [](const Disc& disc) { return disc.is_object(); });
  FindBurdens();
  MeasureGroups();
  FindBlockedDoors();
}

// People that are removed or away keep their disc, so that numbers match ids, but have an empty interval of heights,
// which overlaps none.
void PeopleView::AddPeople() {
  for (std::size_t i = 0; i < count(); ++i) {
    const PersonState& state = person(i);
    const Body& body = scene().body(scene().body_of(PersonId(i)));
    discs_.push_back({.center = state.X_WP.translation(),
                      .velocity = {state.vx, state.vy},
                      .heading = HeadingOf(state),
                      .radius = RadiusOf(scene(), PersonId(i)),
                      .z = Exists(i) ? body.z + state.X_WP.z : ZRange()});
  }
}

// Objects have no velocity here: a held object moves with its robot, whose disc people avoid.
void PeopleView::AddBodies() {
  const std::size_t robots = state().robots.size();
  for (std::size_t i = 0; i < robots + state().objects.size(); ++i) {
    const BodyId id(i);
    const Body& body = scene().body(id);
    if (body.pieces.empty()) continue;
    const Pose& X_WB = workspace_.bodies.X_WB(id);
    Disc disc{.center = X_WB.translation(),
              .radius = body.radius,
              .z = body.z + X_WB.z,
              .is_robot = i < robots,
              .pieces = &workspace_.bodies.pieces_in_world(id)};
    if (disc.is_robot) {
      const Twist& twist = state().robots[i].twist;
      // From R to W, as ORCA needs it.
      disc.velocity = workspace_.bodies.transform(id).Rotate({twist.vx, twist.vy});
    }
    discs_.push_back(disc);
  }
}

void PeopleView::FindBurdens() {
  is_burdened_.assign(count(), false);
  for (const ObjectState& object : state().objects) {
    const std::optional<PersonId> under = object.support ? scene().person_of(*object.support) : std::nullopt;
    if (under) is_burdened_[under->index()] = true;
  }
}

// Followers on another level do not count: the leader would wait for people who are in a lift.
void PeopleView::MeasureGroups() {
  behind_.assign(count(), 0.0);
  for (std::size_t i = 0; i < count(); ++i) {
    const std::optional<PersonId>& leader = world().people[i].leader;
    if (!leader || !Exists(i) || !Exists(leader->index())) continue;
    if (!AreOnOneLevel(person(i).X_WP.z, person(leader->index()).X_WP.z)) continue;
    const double distance = (discs_[i].center - discs_[leader->index()].center).norm();
    behind_[leader->index()] = std::max(behind_[leader->index()], distance);
  }
}

void PeopleView::FindBlockedDoors() {
  for (std::size_t i = 0; i < state().doors.size(); ++i) {
    const DoorState& door = state().doors[i];
    if (door.blocked && door.held && routes().portals().doors[i]) blocked_doors_.push_back(i);
  }
}

}  // namespace troupe
