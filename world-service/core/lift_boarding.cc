#include "world-service/core/lift_boarding.h"

#include <algorithm>
#include <cmath>

#include "world-service/core/pedestrian_goals.h"

namespace troupe {
namespace {

constexpr double kAisle = 0.2;          // m, beside the middle of the doorway, on the way in and out
constexpr double kCallDistance = 2.0;   // m from a lift's entrance
constexpr double kPatience = 300.0;     // s: then a person gives up its goal
constexpr double kSidestep = 0.6;       // of the speed, out of the way of leaving passengers
constexpr double kAtPlace = 0.05;       // m
constexpr double kSlowNearPlace = 0.3;  // m, before a place

// The velocity of a person straight to a point in the frame of a doorway.
// Slower near the point, so that a step does not overshoot it: the person would swing about its place.
Vec2 Towards(const LiftStop& stop, const Vec2& here, const Vec2& to_U, double speed) {
  const Vec2 way = stop.FromU(to_U) - here;
  return speed * std::min(1.0, way.norm() / kSlowNearPlace) * Unit(way);
}

// On the way from the door to a place in the cabin, and back to it.
Vec2 TowardsPlace(const LiftPortal& portal, const LiftStop& stop, const Vec2& here, std::uint32_t place, double speed) {
  const Vec2 place_U = stop.ToU(portal.places[place - 1]);
  const Vec2 here_U = stop.ToU(here);
  if ((here_U - place_U).norm() <= kAtPlace) return {0.0, 0.0};
  // The last part of the way is straight to the place, as soon as the person has come along the aisle to its side.
  const bool is_beside = std::fabs(here_U.x() - place_U.x()) <= 0.15 || std::fabs(here_U.y() - place_U.y()) <= 0.1;
  if (is_beside) return Towards(stop, here, place_U, speed);
  // First into the aisle, then along it: the ways of people to different places cross only there.
  const bool is_in_aisle = std::fabs(here_U.y()) <= kAisle;
  return Towards(stop, here, {is_in_aisle ? place_U.x() : here_U.x(), 0.0}, speed);
}

// Back the same way: to the aisle, and along it out of the cabin, to a point 1 m beyond the lane of people who wait.
Vec2 TowardsDoor(const LiftStop& stop, const Vec2& here, double radius, double speed) {
  const Vec2 here_U = stop.ToU(here);
  const bool is_beside = here_U.x() < -radius && std::fabs(here_U.y()) > kAisle;
  const Vec2 way = stop.FromU({is_beside ? here_U.x() : stop.lane + 1.0, 0.0}) - here;
  return speed * Unit(way);
}

// Any stop of a lift will do for the frame of its cabin while the cabin is between floors; null for a lift that serves
// no people.
const LiftStop* AnyStop(const LiftPortal& portal) {
  for (const std::optional<LiftStop>& stop : portal.stops) {
    if (stop) return &*stop;
  }
  return nullptr;
}

class Rider {
 public:
  Rider(const PeopleView& view, PersonId id, PersonState& person)
      : view_(view),
        id_(id),
        person_(person),
        number_(person.lift - 1),
        portal_(view.routes().portals().lifts[number_]),
        lift_(view.state().lifts[number_]),
        here_(view.disc(id.index()).center),
        radius_(view.disc(id.index()).radius),
        speed_(view.world().person(id).speed) {
    // The state may come from a world before an edit, or from another process: a place that does not exist is none.
    if (person_.place > portal_.places.size()) person_.place = 0;
  }

  RideWalk Walk() {
    if (portal_.IsInside(here_, person_.X_WP.z - lift_.z)) return {.velocity = InCabin(), .is_bound = true};
    // By an edit, or because it was taken out of the cabin, a person may be at a height where the lift does not stop.
    const std::optional<std::uint32_t> floor = portal_.FloorAt(person_.X_WP.z);
    if (!floor) {
      person_.EndRide();
      return {.gave_up = true};
    }
    const LiftStop& stop = *portal_.stops[*floor];
    const Vec2 here_U = stop.ToU(here_);
    const bool is_at_cabin = lift_.floor == *floor && Stands(view_.world(), view_.state(), number_);
    const bool gets_on = person_.place != 0 && person_.floor != *floor && is_at_cabin && !lift_.session;
    const bool is_in_doorway =
        here_U.x() > -radius_ && here_U.x() < stop.outside && std::fabs(here_U.y()) < stop.half_width;
    if (is_in_doorway) {
      if (gets_on) person_.X_WP.z = stop.z;  // a step up or down, onto the floor of the cabin
      const Vec2 velocity = gets_on ? TowardsPlace(portal_, stop, here_, person_.place, speed_)
                                    : TowardsDoor(stop, here_, radius_, speed_);
      return {.velocity = velocity, .is_bound = true};
    }
    // It has left the cabin at its destination: the trip is over, and its height is exactly that of the floor again.
    if (person_.floor == *floor) {
      person_.EndRide();
      person_.X_WP.z = stop.z;
      return {};
    }
    return gets_on ? GetOn(stop, here_U, *floor) : Wait(stop, here_U, *floor);
  }

 private:
  Vec2 InCabin() {
    const WorldState& state = view_.state();
    const std::optional<LiftStop>& stop = portal_.stops[lift_.floor];
    const bool is_open = stop && IsOpen(view_.world(), state, number_);
    // A robot that has the session of the lift has the cabin for itself: people leave it at the next floor.
    const bool wants_off = lift_.floor == person_.floor || lift_.session || person_.place == 0;
    // After too long an attempt it steps back to its place, and tries again after a pause (lift_queue.cc).
    if (is_open && wants_off && person_.boarding_ticks < PassingTicks(view_.world())) {
      return TowardsDoor(*stop, here_, radius_, speed_);
    }
    if (person_.place == 0 && lift_.overloaded) return OutOfOverload();
    if (person_.place == 0) return OutOfDoorway();
    const LiftStop* const any = stop ? &*stop : AnyStop(portal_);
    if (any == nullptr) return {0.0, 0.0};
    return TowardsPlace(portal_, *any, here_, person_.place, speed_);
  }

  // The lift stays where it is, whatever it has been called to, until this person has left it.
  Vec2 OutOfOverload() const {
    const std::optional<std::uint32_t> floor = portal_.FloorAt(lift_.z);
    return floor ? TowardsDoor(*portal_.stops[*floor], here_, radius_, speed_) : Vec2(0.0, 0.0);
  }

  // Without a place in the cabin a person gets out of the way of leaves that close. The cabin may have been called
  // away.
  Vec2 OutOfDoorway() const {
    const std::optional<std::uint32_t> floor = portal_.FloorAt(lift_.z);
    if (!floor || portal_.stops[*floor]->z != lift_.z) return {0.0, 0.0};
    const LiftStop& stop = *portal_.stops[*floor];
    constexpr double kLeaf = 0.15;  // m
    return stop.ToU(here_).x() > -radius_ - kLeaf ? TowardsDoor(stop, here_, radius_, speed_) : Vec2(0.0, 0.0);
  }

  RideWalk GetOn(const LiftStop& stop, const Vec2& here_U, std::uint32_t floor) {
    // A person that is too far to the side would be stopped by the frame of the door: it walks in front of it first,
    // along a route.
    const bool is_before_door = here_U.x() > 0.0 && here_U.x() < stop.lane + kAisle &&
                                std::fabs(here_U.y()) < std::max(kAisle, stop.half_width - radius_);
    if (!is_before_door) return {.is_bound = true, .walks_to = WalkRoutes::Stop{person_.lift - 1, floor}};
    return {.velocity = TowardsPlace(portal_, stop, here_, person_.place, speed_), .is_bound = true};
  }

  RideWalk Wait(const LiftStop& stop, const Vec2& here_U, std::uint32_t floor) {
    const auto tick = static_cast<std::uint32_t>(view_.state().tick);  // the last bits, as of the call
    const double distance = (stop.Entrance() - here_).norm();
    // It calls when it has come near, or stands behind others that have called: the queue may be longer than the
    // distance.
    if (person_.call_tick == 0) {
      const bool is_there = distance <= kCallDistance || (distance <= kQueueReach && IsInQueue(stop.Entrance()));
      if (!is_there) return {.walks_to = WalkRoutes::Stop{person_.lift - 1, floor}};
      person_.call_tick = tick;
    }
    if (tick - person_.call_tick > TicksOf(view_.world(), kPatience)) {
      person_.EndRide();
      return {.gave_up = true};
    }
    // The lane in front of the door is for people who get off: to the nearer side; from the exact middle by number, so
    // that two do not choose the same side for ever.
    const bool is_in_lane =
        here_U.x() > 0.0 && here_U.x() < stop.lane + radius_ && std::fabs(here_U.y()) < stop.half_width + radius_;
    if (is_in_lane) {
      const bool to_left = here_U.y() != 0.0 ? here_U.y() > 0.0 : id_.index() % 2 == 0;
      const Vec2 left(-stop.outward.y(), stop.outward.x());
      return {.velocity = (to_left ? kSidestep : -kSidestep) * speed_ * left};
    }
    if (distance > kQueueReach) return {.walks_to = WalkRoutes::Stop{person_.lift - 1, floor}};
    return {};
  }

  bool IsInQueue(const Vec2& entrance) const {
    return troupe::IsInQueue(view_, id_.index(), entrance, [&](const PersonState& other) {
      return other.lift == person_.lift && other.call_tick != 0 && other.place == 0;
    });
  }

  const PeopleView& view_;
  const PersonId id_;
  PersonState& person_;
  const std::size_t number_;  // of the lift
  const LiftPortal& portal_;
  const LiftState& lift_;
  const Vec2& here_;
  const double radius_;
  const double speed_;
};

}  // namespace

std::optional<std::uint32_t> CabinAround(const PeopleView& view, const Pose& X_WP) {
  const std::vector<LiftPortal>& lifts = view.routes().portals().lifts;
  for (std::size_t i = 0; i < lifts.size(); ++i) {
    if (AnyStop(lifts[i]) == nullptr) continue;
    if (lifts[i].IsInside(X_WP.translation(), X_WP.z - view.state().lifts[i].z)) return static_cast<std::uint32_t>(i);
  }
  return std::nullopt;
}

RideWalk RideLift(const PeopleView& view, PersonId id, PersonState& person) {
  return Rider(view, id, person).Walk();
}

}  // namespace troupe
