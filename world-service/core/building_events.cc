// The events of doors, lifts and people (troupe/event.h, kDoorOpened and later), found by comparing the states before
// and after a step. They are no part of the step's own logic, because a recording or a rewind that steps again has to
// give the same events: both states are all that they depend on.
//
// Openings and heights are compared for equality: a motion that reaches its end is set to exactly 0, 1 or the floor's
// height (doors.cc, lifts.cc), so no tolerance is needed, and an event is told once.
#include "common/spatial/walk_routes.h"
#include "world-service/core/people_view.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

class BuildingEvents {
 public:
  BuildingEvents(const Scene& scene, const WorldState& before, const WorldState& now, std::vector<Event>& events)
      : scene_(scene), world_(scene.world()), before_(before), now_(now), events_(events) {}

  void AddOfDoor(std::size_t i) {
    const DoorState& before = before_.doors[i];
    const DoorState& now = now_.doors[i];
    const ModelId door = world_.doors[i].model;
    if (now.opening == 1.0 && before.opening < 1.0) Add(EventType::kDoorOpened, door);
    if (now.opening == 0.0 && before.opening > 0.0) Add(EventType::kDoorClosed, door);
    if (now.blocked && !before.blocked) Add(EventType::kDoorBlocked, door);
  }

  void AddOfLift(std::size_t i) {
    const LiftState& before = before_.lifts[i];
    const LiftState& now = now_.lifts[i];
    const LiftDescription& lift = world_.lifts[i];
    if (now.z != before.z) {
      for (const LiftFloor& floor : lift.floors) {
        if (before.z == floor.z) Add(EventType::kLiftLeft, lift.model, {}, floor.name);
      }
      const LiftFloor& floor = lift.floors[now.floor];
      if (now.z == floor.z) Add(EventType::kLiftArrived, lift.model, {}, floor.name);
    }
    if (now.blocked && !before.blocked) Add(EventType::kLiftBlocked, lift.model);
  }

  void AddOfPerson(PersonId id) {
    const PersonState& before = before_.people[id.index()];
    const PersonState& now = now_.people[id.index()];
    const ModelId root = world_.person(id).root;
    if (world_.model(root).removed) return;
    // The ride of a person that gets off ends in the same tick (PersonState::EndRide): then the lift is known from the
    // state before.
    if (const std::uint32_t lift = now.lift != 0 ? now.lift : before.lift; lift != 0) {
      const bool was_inside = IsInside(before_, before, lift - 1);
      const bool is_inside = IsInside(now_, now, lift - 1);
      const LiftDescription& description = world_.lifts[lift - 1];
      const std::string& floor = description.floors[now_.lifts[lift - 1].floor].name;
      if (is_inside && !was_inside) Add(EventType::kPersonBoarded, root, description.model, floor);
      if (!is_inside && was_inside) Add(EventType::kPersonAlighted, root, description.model, floor);
    }
    if (HasArrived(id, before, now)) {
      Add(EventType::kPersonArrived, root, {}, world_.goal_sets[now.goals].name);
    }
  }

 private:
  void Add(EventType type, ModelId subject, std::optional<ModelId> other = {}, std::string detail = {}) {
    events_.push_back(
        {.tick = now_.tick, .type = type, .other = other, .detail = std::move(detail), .object = subject});
  }

  bool IsInside(const WorldState& state, const PersonState& person, std::uint32_t lift) const {
    const LiftPortal& portal = scene_.walk_routes().portals().lifts[lift];
    return portal.IsInside(person.X_WP.translation(), person.X_WP.z - state.lifts[lift].z);
  }

  bool IsWithin(PersonId id, const Pose& X_WP, const PersonState& person, double reach) const {
    const GoalSet& set = world_.goal_sets[person.goals];
    if (person.goal >= set.points.size()) return false;
    const WalkRoutes& routes = scene_.walk_routes();
    return (set.points[person.goal] - X_WP.translation()).norm() <= reach &&
           routes.LevelAt(X_WP.z) == routes.LevelOf(id, {person.goals, person.goal});
  }

  // The person has come within the reach of its goal, or waits in a queue there.
  bool HasArrived(PersonId id, const PersonState& before, const PersonState& now) const {
    // A new choice of the same goal set and point is no arrival, and a follower that only takes over its leader's goal
    // has not arrived, either.
    if (world_.goal_sets.empty() || now.goals != before.goals || now.goal != before.goal) return false;
    const double reach = world_.goal_sets[now.goals].reach;
    if (IsWithin(id, before.X_WP, now, reach)) return false;
    const bool waits = now.dwell_ticks > 0 && before.dwell_ticks == 0 && IsWithin(id, now.X_WP, now, kQueueReach);
    return waits || IsWithin(id, now.X_WP, now, reach);
  }

  const Scene& scene_;
  const WorldDescription& world_;
  const WorldState& before_;
  const WorldState& now_;
  std::vector<Event>& events_;
};

}  // namespace

void AddBuildingEvents(const Scene& scene, const WorldState& before, const WorldState& now,
                       std::vector<Event>& events) {
  BuildingEvents building(scene, before, now, events);
  for (std::size_t i = 0; i < now.doors.size(); ++i) building.AddOfDoor(i);
  for (std::size_t i = 0; i < now.lifts.size(); ++i) building.AddOfLift(i);
  for (std::size_t i = 0; i < now.people.size(); ++i) building.AddOfPerson(PersonId(i));
}

}  // namespace troupe
