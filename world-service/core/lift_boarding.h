// The rides of people on lifts: who waits, gets on, stands in the cabin and gets off. Private to this folder.
//
// A person that goes to another level walks to a lift, calls it (PersonState::call_tick) and waits beside the way of
// leaving passengers. Before the doors move, each lift serves its people (ServePeople): while no robot has its session,
// it goes towards the person that called first, stops on the way for others, and gives places in its cabin to the
// people who wait at its floor, once all who get off are out. While a robot has the session, people leave the lift to
// it: they get off where its doors open and wait. So robots never wait for people's calls.
//
// The way into the cabin is scripted, in the frame U of its doorway (docs/conventions.md), and not left to the
// avoidance of others: through the doorway to the aisle in the middle of the cabin, along it, and then aside to the
// assigned place. People who wait stand beside the lane in front of the door. Without these rules two crowds that meet
// in a doorway block each other.
//
// Ticks of calls are the last 32 bits of the tick; only differences of them are used, so that their overflow does no
// harm. ServePeople runs in one thread, before people decide; RideLift is called while people decide, by several
// threads, and changes only the copy of its own person's state.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "world-service/core/pedestrian_goals.h"
#include "world-service/core/people_view.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// What is in a cabin, of what a lift with limits counts.
struct CabinLoad {
  static constexpr double kPersonMass = 75.0;  // kg, the mean that standards of lifts reckon with (EN 81-20)
  std::int32_t bodies = 0;                     // robots and people
  double mass = 0.0;                           // kg
  void AddPerson() {
    ++bodies;
    mass += kPersonMass;
  }
  bool IsWithin(const LiftDescription& lift) const {
    return (lift.capacity == 0 || bodies <= lift.capacity) && (lift.max_load == 0.0 || mass <= lift.max_load);
  }
};
inline bool IsLimited(const LiftDescription& lift) {
  return lift.capacity > 0 || lift.max_load > 0.0;
}
CabinLoad RobotsInCabin(const StepWorkspace& workspace, std::size_t lift);

// Decides for all lifts who gets on, and where each goes next, by the people's calls.
void ServePeople(StepWorkspace& workspace);

// All doors of the floor at which a lift stands are open.
bool IsOpen(const WorldDescription& world, const WorldState& state, std::size_t lift);
// A lift stands at the floor that it was called to.
bool Stands(const WorldDescription& world, const WorldState& state, std::size_t lift);

// For so many ticks a person tries to get on or off; then it lets the lift serve others.
// An obstacle in the doorway, for instance a robot, would else hold the lift at one floor for ever.
inline std::uint32_t PassingTicks(const WorldDescription& world) {
  constexpr double kPassingTime = 15.0;  // s
  return std::max<std::uint32_t>(TicksOf(world, kPassingTime), 1);
}

// The lift in whose cabin a person is, if it is in one.
std::optional<std::uint32_t> CabinAround(const PeopleView& view, const Pose& X_WP);

// The decision of a person on a lift trip, before it avoids others: a velocity, or a stop to walk to.
struct RideWalk {
  Vec2 velocity{0.0, 0.0};                        // m/s
  bool is_bound = false;                          // in a cabin or on its way into one: it does not react to robots
  std::optional<WalkRoutes::Stop> walks_to = {};  // instead of the velocity: it walks to this stop
  bool gave_up = false;                           // it has waited for too long, or is where the lift does not stop
};
// Ends the ride of `person` where it has got off. REQUIRES: person.lift is not 0.
RideWalk RideLift(const PeopleView& view, PersonId id, PersonState& person);

}  // namespace troupe
