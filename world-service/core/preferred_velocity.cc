#include "world-service/core/preferred_velocity.h"

#include <algorithm>
#include <optional>

#include "common/model/zones.h"
#include "world-service/core/lift_boarding.h"
#include "world-service/core/pedestrian_goals.h"

namespace troupe {
namespace {

constexpr double kSlowDown = 0.5;      // s: so far ahead of its goal a person slows down
constexpr double kTogether = 1.5;      // m between the people of a group
constexpr double kTooFar = 3.0;        // m at which a leader waits
constexpr double kPassable = 0.9;      // the opening of a door from which on people pass
constexpr double kHalfOpen = 0.5;      // of one that is blocked
constexpr double kWaitingGap = 0.3;    // m between people who wait and the sweep of a leaf
constexpr double kMinGap = 0.03;       // m: a nearer person steps back
constexpr double kSteppingBack = 0.6;  // of the speed
constexpr double kGivenUp = 1.0;       // s: so long a person stands after a goal that it cannot reach

class Walk {
 public:
  Walk(const PeopleView& view, PersonId id, PersonState& person)
      : view_(view),
        id_(id),
        i_(id.index()),
        description_(view.world().person(id)),
        routes_(view.routes()),
        here_(view.disc(id.index()).center),
        person_(person) {
    const std::optional<PersonId>& leader = description_.leader;
    // Followers of a leader that is removed or away go on alone.
    if (leader && view_.Exists(leader->index())) leader_ = leader->index();
  }

  AloneWalk Decide() {
    if (IsEvacuated()) {
      leader_.reset();  // each leaves by itself
    } else if (leader_) {
      FollowGoals();
    } else {
      const bool ends_waiting = person_.goals_chosen > 0 && person_.dwell_ticks > 0 && --person_.dwell_ticks == 0;
      if (person_.goals_chosen == 0 || ends_waiting) ChooseGoal(view_.world(), id_, person_);
    }
    AloneWalk walk;
    asked_ = 0;
    // While it waits at a goal the person stands, but still makes room for leaves and keeps to its group.
    if (person_.dwell_ticks == 0 && person_.goals_chosen > 0) walk = ToGoal();
    if (!walk.is_bound) KeepTogether(walk.velocity);
    if (!walk.is_bound) MakeRoom(walk.velocity);
    // Asked for in this tick only: doors forget a person that does not ask again.
    person_.door = asked_;
    walk.leaves = leaves_;
    return walk;
  }

 private:
  bool IsOnLevelOf(const PersonState& other) const { return AreOnOneLevel(person_.X_WP.z, other.X_WP.z); }

  // It is on its way to the exits of an evacuation zone, or sets out for them because it is in one that is on.
  bool IsEvacuated() {
    const WorldDescription& world = view_.world();
    for (std::size_t i = 0; i < world.zones.size(); ++i) {
      const ZoneDescription& zone = world.zones[i];
      if (!zone.exits) continue;
      if (person_.goals == *zone.exits) {
        if (person_.dwell_ticks > 0) --person_.dwell_ticks;  // after a way that it could not find
        return true;
      }
      if (!view_.state().zones[i].is_on || !IsInZone(world, zone, here_, person_.X_WP.z)) continue;
      SetOutFor(*zone.exits);
      return true;
    }
    return false;
  }

  // The nearest exit by the way to it; one on another level only if none is on this one.
  void SetOutFor(std::uint32_t exits) {
    const std::size_t level = routes_.LevelAt(person_.X_WP.z);
    std::optional<std::uint32_t> nearest;
    double least = 0.0;
    for (std::uint32_t i = 0; i < view_.world().goal_sets[exits].points.size(); ++i) {
      const WalkRoutes::Goal goal{exits, i};
      if (routes_.LevelOf(id_, goal) != level) continue;
      const std::optional<double> length = routes_.Length(id_, goal, here_);
      if (!length || (nearest && *length >= least)) continue;
      nearest = i;
      least = *length;
    }
    for (std::uint32_t i = 0; !nearest && i < view_.world().goal_sets[exits].points.size(); ++i) {
      const WalkRoutes::Goal goal{exits, i};
      if (routes_.LevelOf(id_, goal) != level && routes_.FindRide(id_, level, goal, here_)) nearest = i;
    }
    person_.goals = exits;
    person_.goal = nearest.value_or(0);
    ++person_.goals_chosen;
    person_.dwell_ticks = person_.watch_ticks = 0;
    ChangeRide();
  }

  // Its goal is another one: in the cabin it rides on to that, without having got off. Else it lets the lift go.
  void ChangeRide() {
    if (person_.lift == 0) return;
    const std::uint32_t lift = person_.lift - 1;
    if (person_.place != 0 && CabinAround(view_, person_.X_WP) == lift) {
      GetIn(lift, {person_.goals, person_.goal});
    } else {
      person_.EndRide();
    }
  }

  // The goals of the leader. On another level than that the person goes on to them.
  void FollowGoals() {
    const PersonState& first = view_.person(*leader_);
    const bool has_changed = person_.goals != first.goals || person_.goal != first.goal;
    person_.goals = first.goals;
    person_.goal = first.goal;
    person_.goals_chosen = first.goals_chosen;
    person_.dwell_ticks = IsOnLevelOf(first) && person_.lift == 0 ? first.dwell_ticks : 0;
    // A ride to a goal that is not valid any more ends where the person has not got on.
    if (has_changed && person_.place == 0) person_.EndRide();
  }

  // The next goal comes after a while, as after one that it has reached: the search for a way takes time, too. A
  // follower waits for its leader's choice.
  void GiveUp() {
    if (!leader_) person_.dwell_ticks = std::max<std::uint32_t>(TicksOf(view_.world(), kGivenUp), 1);
  }
  // All of a group leave one by one: a follower that waited at the exit would be in its leader's way.
  void Arrive() {
    if (IsExit(view_.world(), person_.goals)) {
      leaves_ = true;
    } else if (!leader_) {
      ArriveAtGoal(view_.world(), id_, person_);
    }
  }

  // Without a time to wait it does not stop for a tick at its goal, in the way of all behind it.
  Vec2 SetOut() const {
    const bool goes_on = person_.dwell_ticks == 0 && !view_.world().goal_sets[person_.goals].next.empty();
    return goes_on ? Vec2(view_.person(i_).vx, view_.person(i_).vy) : Vec2(0.0, 0.0);
  }

  AloneWalk ToGoal() {
    const GoalSet& set = view_.world().goal_sets[person_.goals];
    const WalkRoutes::Goal goal{person_.goals, person_.goal};
    if (set.points.empty()) {
      Arrive();
      return {};
    }
    // Not on a lift trip: it is at its goal, on the goal's level, or begins a trip.
    if (person_.lift == 0) {
      const std::size_t level = routes_.LevelAt(person_.X_WP.z);
      const bool is_there = level == routes_.LevelOf(id_, goal) && (set.points[goal.point] - here_).norm() <= set.reach;
      if (is_there) {
        Arrive();  // also in a cabin
        return {SetOut()};
      }
      if (const std::optional<std::uint32_t> lift = CabinAround(view_, person_.X_WP)) {
        GetIn(*lift, goal);
      } else if (level == routes_.LevelOf(id_, goal)) {
        return {ToGoalOnLevel(set, goal)};
      } else if (const auto ride = routes_.FindRide(id_, level, goal, here_)) {
        person_.lift = ride->lift + 1;
        person_.floor = ride->to;
      } else {
        GiveUp();
        return {};
      }
    }
    return Ride();
  }

  // It is in a cabin without having called it: it rides to its goal, or gets off.
  void GetIn(std::uint32_t lift, const WalkRoutes::Goal& goal) {
    const LiftPortal& portal = routes_.portals().lifts[lift];
    person_.lift = lift + 1;
    person_.floor = view_.state().lifts[lift].floor;
    for (std::size_t i = 0; i < portal.stops.size(); ++i) {
      if (!portal.stops[i] || routes_.LevelAt(portal.stops[i]->z) != routes_.LevelOf(id_, goal)) continue;
      person_.floor = static_cast<std::uint32_t>(i);
      break;
    }
  }

  AloneWalk Ride() {
    const RideWalk ride = RideLift(view_, id_, person_);
    if (ride.gave_up) {
      GiveUp();
      return {};
    }
    if (!ride.walks_to) return {ride.velocity, ride.is_bound};
    // The next point in sight on the way to the stop, around walls.
    const std::optional<WalkRoutes::Ahead> ahead = routes_.AheadTo(id_, *ride.walks_to, here_);
    if (!ahead) {
      person_.EndRide();
      GiveUp();
      return {};
    }
    // At full speed: the stop is not the end of the way.
    return {PassDoors(*ahead, description_.speed * Unit(ahead->point - here_)), ride.is_bound};
  }

  Vec2 ToGoalOnLevel(const GoalSet& set, const WalkRoutes::Goal& goal) {
    const std::optional<Vec2> target = routes_.Target(id_, goal);
    if (!target) {
      GiveUp();
      return {0.0, 0.0};
    }
    const double distance = (*target - here_).norm();
    if (distance <= set.reach || (distance <= kQueueReach && IsInQueue(*target))) {
      Arrive();
      return SetOut();
    }
    const std::optional<WalkRoutes::Ahead> ahead = routes_.AheadTo(id_, goal, here_);
    if (!ahead) {
      GiveUp();  // no way leads there
      return {0.0, 0.0};
    }
    const double speed = description_.speed;
    return PassDoors(*ahead, speed * std::min(1.0, distance / (kSlowDown * speed + 1e-9)) * Unit(ahead->point - here_));
  }

  // The point itself may be taken.
  bool IsInQueue(const Vec2& target) const {
    return troupe::IsInQueue(view_, i_, target, [&](const PersonState& other) {
      return other.goals == person_.goals && other.goal == person_.goal && other.dwell_ticks != 0;
    });
  }

  void KeepTogether(Vec2& velocity) const {
    if (!leader_) {
      // A leader slows down, and does not stop: a follower that cannot come would else stop the group for ever.
      if (view_.behind(i_) > kTooFar) velocity *= 0.3;
      return;
    }
    if (!IsOnLevelOf(view_.person(*leader_)) || person_.lift != 0) return;
    const Vec2 to_leader = view_.disc(*leader_).center - here_;
    const double distance = to_leader.norm();
    if (person_.dwell_ticks > 0) velocity = Vec2(0.0, 0.0);
    // Towards the leader in addition to the way to the goal, in proportion to the gap.
    if (distance > kTogether) velocity += std::min(description_.speed, distance - kTogether) * Unit(to_leader);
  }

  // Doors.

  bool IsPassable(const DoorState& door) const {
    return door.opening >= kPassable || (door.blocked && door.opening >= kHalfOpen);
  }

  // Asks for the door on the way, if that does not stay open by itself, and waits beside the sweep of its leaves until
  // it is open.
  Vec2 PassDoors(const WalkRoutes::Ahead& ahead, const Vec2& velocity) {
    const double radius = view_.disc(i_).radius;
    const auto clearance_of = [&](std::size_t door) { return routes_.portals().doors[door]->ClearanceOf(here_); };
    if (!ahead.door) {
      // It asks for the door behind it until it is beyond the sweep.
      const bool is_close = person_.door != 0 && routes_.portals().doors[person_.door - 1] &&
                            clearance_of(person_.door - 1).distance < radius + kWaitingGap;
      if (is_close) asked_ = person_.door;
      return velocity;
    }
    const DoorState& door = view_.state().doors[*ahead.door];
    const bool is_passable = IsPassable(door);
    // A door that is to stay open, by an order, needs no request.
    if (!is_passable || door.target < 1.0) asked_ = static_cast<std::uint32_t>(*ahead.door + 1);
    if (is_passable) return velocity;
    const DoorPortal::Clearance clearance = clearance_of(*ahead.door);
    const double gap = clearance.distance - radius;
    if (gap < kMinGap) return kSteppingBack * description_.speed * clearance.away;
    if (gap < kWaitingGap) return {0.0, 0.0};
    return velocity * std::min(1.0, (gap - 0.5 * kWaitingGap) / (kSlowDown * description_.speed + 1e-9));
  }

  // Steps out of the way of a leaf that opens for another person.
  void MakeRoom(Vec2& velocity) const {
    for (const std::size_t door : view_.blocked_doors()) {
      const DoorPortal& portal = *routes_.portals().doors[door];
      const bool passes = asked_ == door + 1 && IsPassable(view_.state().doors[door]);
      if (passes || !portal.closed.front().z.Overlaps(view_.disc(i_).z)) continue;
      const DoorPortal::Clearance clearance = portal.ClearanceOf(here_);
      if (clearance.distance - view_.disc(i_).radius >= kMinGap) continue;
      velocity = kSteppingBack * description_.speed * clearance.away;
      return;
    }
  }

  const PeopleView& view_;
  const PersonId id_;
  const std::size_t i_;
  const PersonDescription& description_;
  const WalkRoutes& routes_;
  const Vec2& here_;
  PersonState& person_;
  std::optional<std::size_t> leader_;
  std::uint32_t asked_ = 0;  // the door for which it asks in this tick, from 1 on
  bool leaves_ = false;
};

}  // namespace

AloneWalk WalkAlone(const PeopleView& view, PersonId id, PersonState& person) {
  return Walk(view, id, person).Decide();
}

}  // namespace troupe
