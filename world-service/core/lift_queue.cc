// The service of people by lifts: ServePeople of lift_boarding.h.
//
// Each lift serves the person whose turn is the earliest, the others on the way there: a fair order, in which no person
// waits for ever while others keep calling. A turn is the tick of the call; an attempt to get on that fails (a
// blocked doorway) puts the person behind all that have called since, so that one blocked person does not stop a
// lift.
//
// A lift stays at a floor while people get off or on. Places in the cabin are assigned before people walk in, and only
// as many as are free of robots and objects, so that no person has to come out again.
//
// All decisions follow from the states of persons and lifts, in the order of ids; nothing else is remembered between
// ticks.
#include <algorithm>
#include <cmath>
#include <memory_resource>
#include <optional>
#include <vector>

#include "common/spatial/walk_routes.h"
#include "world-service/core/lift_boarding.h"
#include "world-service/core/pedestrian_goals.h"

namespace troupe {
namespace {

// A person that has called a lift, or is in it.
struct Passenger {
  PersonState* state = nullptr;
  double radius = 0.0;  // m
  bool is_inside = false;
  std::optional<std::uint32_t> at = {};  // the floor at which it is outside
  // The floor at which the lift serves it next.
  std::optional<std::uint32_t> Wants() const { return is_inside ? std::optional(state->floor) : at; }
  // The tick that decides its turn: of its call, or, while it waits, of its last failed attempt to get on.
  std::uint32_t turn() const { return state->call_tick + (is_inside || state->place != 0 ? 0 : state->boarding_ticks); }
};

class LiftService {
 public:
  LiftService(StepWorkspace& workspace, std::size_t number, const std::vector<PersonId>& people)
      : workspace_(workspace),
        number_(number),
        description_(workspace.world().lifts[number]),
        portal_(workspace.scene.walk_routes().portals().lifts[number]),
        lift_(workspace.next.lifts[number]),
        now_(static_cast<std::uint32_t>(workspace.next.tick)),
        is_open_(IsOpen(workspace.world(), workspace.next, number)),
        is_stuck_(!is_open_ && IsStuck()) {
    for (const PersonId id : people) {
      PersonState& state = workspace.next.people[id.index()];
      const Vec2 here = state.X_WP.translation();
      Passenger passenger{.state = &state,
                          .radius = RadiusOf(workspace.scene, id),
                          .is_inside = portal_.IsInside(here, state.X_WP.z - lift_.z)};
      if (state.place > portal_.places.size()) state.place = 0;
      if (!passenger.is_inside) passenger.at = portal_.FloorAt(state.X_WP.z);
      // People who are still on their way to the lift have no turn.
      if (passenger.is_inside || state.call_tick != 0) passengers_.push_back(passenger);
    }
  }

  void Serve() {
    for (Passenger& passenger : passengers_) CountPassing(passenger);
    // A robot alone commands the lift: people get off by themselves, and wait.
    if (lift_.session) return;
    if (lift_.overloaded) SendOneOut();
    for (Passenger& passenger : passengers_) {
      if (!passenger.is_inside || passenger.state->place != 0) continue;
      // A person that was in the cabin at the start, or was moved into it, gets a place if there is one; else it gets
      // out.
      passenger.state->place = FreePlace(passenger).value_or(0);
    }
    // On its way the lift keeps its destination: a cabin that turned back for each new call would never arrive.
    if (!Stands(workspace_.world(), workspace_.next, number_)) return;
    // Off before on: places become free, and the doorway has one direction at a time.
    if (AreGettingOff() || LetGetOn() || AreGettingOn()) return;
    if (const std::optional<std::uint32_t> floor = NextFloor()) lift_.floor = *floor;
  }

 private:
  // Of too many in the cabin the one that called last leaves; of several at once that of the largest id.
  void SendOneOut() {
    Passenger* last = nullptr;
    for (Passenger& each : passengers_) {
      if (!each.is_inside) continue;
      if (each.state->place == 0) return;  // one is on its way out
      const bool is_later = last == nullptr || now_ - each.state->call_tick <= now_ - last->state->call_tick;
      if (is_later) last = &each;
    }
    if (last != nullptr) last->state->place = 0;
  }

  // The lift carries the passenger, too, with all who have a place in the cabin, and, for one who waits outside, with
  // all who are in there.
  bool Carries(const Passenger& passenger) const {
    if (!IsLimited(description_)) return true;
    CabinLoad load = RobotsInCabin(workspace_, number_);
    for (const Passenger& each : passengers_) {
      const bool counts = each.state->place != 0 || (each.is_inside && !passenger.is_inside);
      if (&each != &passenger && counts) load.AddPerson();
    }
    load.AddPerson();
    return load.IsWithin(description_);
  }

  // A body is in the way of a door that opens at this floor.
  bool IsStuck() const {
    if (!Stands(workspace_.world(), workspace_.next, number_)) return false;
    const std::vector<std::size_t>& doors = description_.floors[lift_.floor].doors;
    return std::any_of(doors.begin(), doors.end(),
                       [&](std::size_t door) { return workspace_.next.doors[door].blocked; });
  }

  std::uint32_t limit() const { return PassingTicks(workspace_.world()); }

  // The time for which a person has been getting on or off at this floor. A person that takes too long, because its way
  // is blocked, goes to the end of the queue, as do people who wait at a door that cannot open.
  void CountPassing(Passenger& passenger) {
    PersonState& state = *passenger.state;
    if (passenger.is_inside) {
      // A person in the cabin that has not called, because it began there, has called now.
      if (state.call_tick == 0) state.call_tick = now_;
      const bool gets_off =
          (is_open_ || is_stuck_) && (state.floor == lift_.floor || lift_.session || state.place == 0);
      state.boarding_ticks = gets_off ? (state.boarding_ticks + 1) % (2 * limit()) : 0;  // it tries again after a pause
      if (state.boarding_ticks == limit()) state.call_tick = now_;
      return;
    }
    if (state.place == 0) {
      // A count that is longer than the time since the call is of an earlier way out of a cabin.
      if (state.boarding_ticks > now_ - state.call_tick) state.boarding_ticks = 0;  // of its way out of the cabin
      if (is_stuck_ && passenger.at == lift_.floor) state.boarding_ticks = now_ - state.call_tick;
      return;
    }
    const bool gets_on = is_open_ && !lift_.session && passenger.at == lift_.floor;
    if (gets_on && ++state.boarding_ticks < limit()) return;
    // Its floor is the one at which it is: it has got off, and is still in the doorway.
    if (passenger.at == state.floor) return;
    state.place = 0;
    state.boarding_ticks = gets_on ? now_ - state.call_tick : 0;
  }

  bool AreGettingOff() const {
    return std::any_of(passengers_.begin(), passengers_.end(), [&](const Passenger& each) {
      return each.is_inside && each.state->floor == lift_.floor && each.state->boarding_ticks < limit();
    });
  }
  bool IsGettingOn(const Passenger& each) const {
    return !each.is_inside && each.state->place != 0 && each.at == lift_.floor;
  }
  bool AreGettingOn() const {
    return std::any_of(passengers_.begin(), passengers_.end(),
                       [&](const Passenger& each) { return IsGettingOn(each); });
  }
  bool Waits(const Passenger& each, std::uint32_t floor) const {
    return !each.is_inside && each.state->place == 0 && each.at == floor && each.state->floor != floor;
  }

  // The passenger with the earliest turn for whom accept(passenger) is true; of equal turns the first by
  // id.
  template <typename Accept>
  const Passenger* Oldest(Accept accept) const {
    const Passenger* oldest = nullptr;
    for (const Passenger& each : passengers_) {
      // Differences to the present tick, modulo 2^32: they are right across the overflow of ticks, a comparison of the
      // ticks themselves is not.
      const bool is_older = oldest == nullptr || now_ - each.turn() > now_ - oldest->turn();
      if (is_older && accept(each)) oldest = &each;
    }
    return oldest;
  }
  const Passenger* Oldest() const {
    return Oldest([](const Passenger& each) { return each.Wants().has_value(); });
  }

  // Others get on only where the oldest one is, or with it in the cabin: so no one waits for ever.
  bool MayPickUp(std::uint32_t floor) const {
    const Passenger* const oldest = Oldest();
    return oldest != nullptr && (oldest->is_inside || oldest->at == floor);
  }

  // People in the cabin have to go on, and one who waits here has failed to get on a short while ago, because of the
  // crowd before the doorway: the lift leaves, and returns for the others.
  bool IsHeldUp() const {
    const bool has_riders = std::any_of(passengers_.begin(), passengers_.end(), [&](const Passenger& each) {
      return each.is_inside && each.state->place != 0 && each.state->floor != lift_.floor;
    });
    return has_riders && std::any_of(passengers_.begin(), passengers_.end(), [&](const Passenger& each) {
             return Waits(each, lift_.floor) && each.state->boarding_ticks > 0 && now_ - each.turn() < limit();
           });
  }

  // Of the people who wait at this floor: the one with the earliest turn while none is getting on, so that no one waits
  // for ever, and then the nearest to the door, which is in the way of the others. People whose turn has just ended are
  // left to a later tick, so that the lift serves the others.
  const Passenger* NextToGetOn() const {
    const auto waits = [&](const Passenger& each) { return Waits(each, lift_.floor) && each.turn() != now_; };
    if (!AreGettingOn()) return Oldest(waits);
    const Vec2& door = portal_.stops[lift_.floor]->door;
    const Passenger* nearest = nullptr;
    double least = 0.0;
    for (const Passenger& each : passengers_) {
      if (!waits(each)) continue;
      const double distance = (each.state->X_WP.translation() - door).squaredNorm();
      if (nearest != nullptr && distance >= least) continue;
      nearest = &each;
      least = distance;
    }
    return nearest;
  }

  // Gives places to the people who wait at this floor, and keeps the lift there for them until its doors are open.
  bool LetGetOn() {
    if (!MayPickUp(lift_.floor) || IsHeldUp()) return false;
    bool stays = false;
    while (true) {
      const Passenger* const next = NextToGetOn();
      const std::optional<std::uint32_t> place = next != nullptr ? FreePlace(*next) : std::nullopt;
      if (!place) return stays;
      stays = true;
      if (!is_open_) return true;
      next->state->place = *place;
      next->state->boarding_ticks = 0;
    }
  }

  // The first place that no person has, and on which no robot or object is in the way of this one; from 1 on.
  std::optional<std::uint32_t> FreePlace(const Passenger& passenger) const {
    if (!Carries(passenger)) return std::nullopt;
    for (std::uint32_t place = 1; place <= portal_.places.size(); ++place) {
      const bool is_given = std::any_of(passengers_.begin(), passengers_.end(),
                                        [&](const Passenger& each) { return each.state->place == place; });
      if (!is_given && IsClear(portal_.places[place - 1], passenger.radius)) return place;
    }
    return std::nullopt;
  }
  // For a person of that radius.
  bool IsClear(const Vec2& place, double radius) const {
    // The margins leave out what only touches the floor or the ceiling, and the cabin itself is a mounted object.
    constexpr double kRoom = 0.05;  // m
    constexpr double kKnee = 0.1;
    const double reach = radius + kRoom;
    const ZRange z{lift_.z + kKnee, lift_.z + portal_.height - kKnee};
    std::pmr::vector<BodyId> bodies;
    workspace_.bodies.Query(Rectangle::Around(place, reach), bodies);
    return std::none_of(bodies.begin(), bodies.end(), [&](const BodyId body) {
      if (workspace_.scene.person_of(body) || workspace_.IsMounted(body)) return false;
      const std::vector<ConvexPiece>& pieces = workspace_.bodies.pieces_in_world(body);
      return std::any_of(pieces.begin(), pieces.end(), [&](const ConvexPiece& piece) {
        return piece.obstacle && piece.z.Overlaps(z) &&
               FindNearestPoints(std::span(&place, 1), piece.vertices).distance < reach;
      });
    });
  }

  // The floor of the oldest call, or one on the way there at which others get off or on.
  std::optional<std::uint32_t> NextFloor() const {
    const Passenger* const oldest = Oldest([&](const Passenger& each) {
      return each.Wants() && *each.Wants() != lift_.floor && (each.is_inside || FreePlace(each));
    });
    if (oldest == nullptr) return std::nullopt;
    std::uint32_t next = *oldest->Wants();
    // Heights, not numbers of floors: a file may list floors in any order.
    const double start = description_.floors[lift_.floor].z;
    const double end = description_.floors[next].z;
    for (const Passenger& each : passengers_) {
      if (!each.Wants() || (!each.is_inside && (!oldest->is_inside || each.state->place != 0))) continue;
      const double z = description_.floors[*each.Wants()].z;
      const bool is_between = (z - start) * (end - start) > 0.0 && std::fabs(z - start) < std::fabs(end - start);
      const bool is_first = is_between && std::fabs(z - start) < std::fabs(description_.floors[next].z - start);
      if (is_first && (each.is_inside || FreePlace(each))) next = *each.Wants();
    }
    return next;
  }

  StepWorkspace& workspace_;
  const std::size_t number_;
  const LiftDescription& description_;
  const LiftPortal& portal_;
  LiftState& lift_;
  const std::uint32_t now_;  // ticks, like the others of people: the last 32 bits, of which differences are taken
  const bool is_open_;
  const bool is_stuck_;
  std::vector<Passenger> passengers_;  // by id
};

}  // namespace

bool Stands(const WorldDescription& world, const WorldState& state, std::size_t lift) {
  return state.lifts[lift].z == world.lifts[lift].floors[state.lifts[lift].floor].z;
}

bool IsOpen(const WorldDescription& world, const WorldState& state, std::size_t lift) {
  if (!Stands(world, state, lift)) return false;
  const LiftFloor& floor = world.lifts[lift].floors[state.lifts[lift].floor];
  return std::all_of(floor.doors.begin(), floor.doors.end(),
                     [&](std::size_t door) { return state.doors[door].opening == 1.0; });
}

void ServePeople(StepWorkspace& workspace) {
  const WorldDescription& world = workspace.world();
  if (world.people.empty() || world.lifts.empty()) return;
  // By lift, each in the order of ids.
  std::vector<std::vector<PersonId>> people(world.lifts.size());
  for (std::size_t i = 0; i < workspace.next.people.size(); ++i) {
    const PersonState& person = workspace.next.people[i];
    if (person.lift != 0 && !world.model(world.people[i].root).removed) people[person.lift - 1].emplace_back(i);
  }
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (!people[i].empty()) LiftService(workspace, i, people[i]).Serve();
  }
}

}  // namespace troupe
