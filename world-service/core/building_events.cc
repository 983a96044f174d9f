// The events of doors, lifts and people (troupe/event.h, kDoorOpened and later), found by comparing the states before
// and after a step. They are no part of the step's own logic, because a recording or a rewind that steps again has to
// give the same events: both states are all that they depend on.
//
// Openings and heights are compared for equality: a motion that reaches its end is set to exactly 0, 1 or the floor's
// height (doors.cc, lifts.cc), so no tolerance is needed, and an event is told once.
#include <cstdio>
#include <string>
#include <utility>

#include "common/model/lane_rules.h"
#include "common/spatial/walk_routes.h"
#include "world-service/core/people_view.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

std::string LimitText(double speed) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g m/s", speed);
  return text;
}

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
    if (!now.overloaded || before.overloaded) return;
    for (const LiftFloor& floor : lift.floors) {
      if (now.z == floor.z) return Add(EventType::kLiftOverloaded, lift.model, {}, floor.name);
    }
  }

  // A lane that has got another rule, or none any more.
  void AddOfLanes() {
    const std::vector<LaneRule>& before = before_.lane_rules;
    const std::vector<LaneRule>& now = now_.lane_rules;
    for (std::size_t i = 0, j = 0; i < before.size() || j < now.size();) {
      const bool is_old = j == now.size() || (i < before.size() && before[i].lane < now[j].lane);
      if (is_old) {
        AddOfLane(before[i++].lane, "open");
        continue;
      }
      const bool is_new = i == before.size() || now[j].lane < before[i].lane;
      if (is_new || before[i].speed_limit != now[j].speed_limit) {
        AddOfLane(now[j].lane, now[j].speed_limit == 0.0 ? "closed" : LimitText(now[j].speed_limit));
      }
      if (!is_new) ++i;
      ++j;
    }
  }

  void AddOfZone(std::size_t i) {
    if (now_.zones[i].is_on == before_.zones[i].is_on) return;
    AddPlain(EventType::kZoneSwitched, world_.zones[i].name + (now_.zones[i].is_on ? " on" : " off"));
  }

  void AddOfFlow(std::size_t i) {
    const std::string& name = world_.flows[i].name;
    if (now_.flows[i].arrived > before_.flows[i].arrived) AddPlain(EventType::kGoodsArrived, name);
    if (now_.flows[i].refused > before_.flows[i].refused) AddPlain(EventType::kGoodsRefused, name);
  }

  // Of the jobs before: they are in the same order now, less those that are done.
  void AddOfJobs() {
    auto now = now_.jobs.begin();
    for (const Job& before : before_.jobs) {
      const bool is_there = now != now_.jobs.end() && now->flow == before.flow && now->number == before.number;
      const std::string& name = world_.flows[before.flow].name;
      if (!is_there) {
        AddPlain(EventType::kDelivered, name, before.robot);
        continue;
      }
      if (now->is_loaded && !before.is_loaded) AddPlain(EventType::kGoodsLoaded, name, now->robot);
      ++now;
    }
  }

  void AddOfPerson(PersonId id) {
    const PersonState& before = before_.people[id.index()];
    const PersonState& now = now_.people[id.index()];
    const ModelId root = world_.person(id).root;
    if (world_.model(root).removed) return;
    if (IsAway(before) != IsAway(now)) Add(IsAway(now) ? EventType::kPersonLeft : EventType::kPersonEntered, root);
    if (IsAway(before) || IsAway(now)) return;
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

  void AddPlain(EventType type, std::string detail, std::optional<RobotId> robot = {}) {
    events_.push_back({.tick = now_.tick, .type = type, .robot = robot, .detail = std::move(detail)});
  }
  void AddOfLane(std::uint32_t lane, const std::string& rule) {
    if (LaneOf(world_, lane).start().is_between) return;  // told of its first part
    AddPlain(EventType::kLaneSwitched, NameOfLane(world_, lane) + ": " + rule);
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
  building.AddOfLanes();
  for (std::size_t i = 0; i < now.zones.size(); ++i) building.AddOfZone(i);
  for (std::size_t i = 0; i < now.flows.size(); ++i) building.AddOfFlow(i);
  building.AddOfJobs();
}

}  // namespace troupe
