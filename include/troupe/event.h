// Event: a change during a tick that is reported to observers. Steps return events in a fixed order.
//
// Events tell, they decide nothing: a run without observers has the same states.
#pragma once

#include <optional>
#include <string>

#include "troupe/enum_names.h"
#include "troupe/fields.h"
#include "troupe/ids.h"

namespace troupe {

enum class EventType : std::uint8_t {
  kStallBegan = 0,        // the robot's motion was cut short; `other` is the obstacle, none for the ground
  kStallEnded = 1,        // it moves freely again
  kJoined = 2,            // an agent controls the robot from now on
  kLeft = 3,              // the robot's agent left or was lost
  kProposalRejected = 4,  // `detail` is the reason
  kBlocked = 5,       // a joint's motion was cut short; `detail` names it, `other` is the obstacle, none for the ground
  kGripped = 6,       // the robot's gripper, named by `detail`, holds `object` from now on
  kReleased = 7,      // it has released `object`
  kLanded = 8,        // `object` has come to rest on `other`, none for the ground
  kUnstable = 9,      // `object` has come to rest on `other`, its centre not above a support
  kOutOfEnergy = 10,  // the robot's store is empty: it stops
  kSaid = 11,         // the robot's controller says `detail`
  kReported = 12,     // the robot's controller or agent reports the text `detail`; not of the step
  // `object` is the model of the door, of the lift, or the root of the person.
  kDoorOpened = 13,      // it is fully open
  kDoorClosed = 14,      // it is closed
  kDoorBlocked = 15,     // a body cuts its motion short
  kLiftLeft = 16,        // its cabin leaves the floor `detail`
  kLiftArrived = 17,     // its cabin stands at the floor `detail`
  kLiftBlocked = 18,     // a body cuts the cabin's motion short
  kPersonBoarded = 19,   // the person is in the cabin of the lift `other`; `detail` is the lift's floor
  kPersonAlighted = 20,  // the person has left that cabin
  kPersonArrived = 21,   // the person has reached a goal of the set `detail`
  kLiftOverloaded = 22,  // more is in its cabin than it carries: it does not leave the floor `detail`
  // Without an object.
  kLaneSwitched = 23,  // `detail` is the lane, and closed, open or the limit of its speed
  kZoneSwitched = 24,  // `detail` is the zone, and on or off
  kGoodsArrived = 25,  // goods of the flow `detail` wait for a robot
  kGoodsRefused = 26,  // there is no room for goods of the flow `detail`
  kGoodsLoaded = 27,   // `robot` has goods of the flow `detail`
  kDelivered = 28,     // `robot` has brought them to their end
  // Of robots on their ways (RobotWait).
  kWaitBegan = 29,       // the robot has waited for 10 s, for `other` or before the lane `detail`
  kWaitEnded = 30,       // it goes on, after a wait that was told; `detail` has its duration
  kDeadlockBroken = 31,  // the robot goes on; the robots `detail` had waited for each other
  kReplanned = 32,       // the robot has met `other` on a lane, which is closed for a time; `detail` names it
  kNoWay = 33,           // the robot has had no way to its goal for 10 s; `detail` names the goal
  // Of visitors (VisitorDescription): `object` is the root of the person.
  kPersonEntered = 34,  // the person has come into the world
  kPersonLeft = 35,     // it has left the world
};
// The events of doors, lifts and people: they are frequent, and summaries count them instead of telling each.
constexpr bool IsOfBuilding(EventType type) {
  return (type >= EventType::kDoorOpened && type <= EventType::kDelivered) || type >= EventType::kPersonEntered;
}
// The events of robots on their ways, which are frequent, too.
constexpr bool IsOfTraffic(EventType type) {
  return type >= EventType::kWaitBegan && type <= EventType::kNoWay;
}
constexpr auto NamesOf(EventType) {
  return std::array{
      "stall_began",   "stall_ended",     "joined",          "left",           "proposal_rejected", "blocked",
      "gripped",       "released",        "landed",          "unstable",       "out_of_energy",     "said",
      "reported",      "door_opened",     "door_closed",     "door_blocked",   "lift_left",         "lift_arrived",
      "lift_blocked",  "person_boarded",  "person_alighted", "person_arrived", "lift_overloaded",   "lane_switched",
      "zone_switched", "goods_arrived",   "goods_refused",   "goods_loaded",   "delivered",         "wait_began",
      "wait_ended",    "deadlock_broken", "replanned",       "no_way",         "person_entered",    "person_left"};
}

struct Event {
  Tick tick = 0;
  EventType type = EventType::kStallBegan;
  std::optional<RobotId> robot = {};
  std::optional<ModelId> other = {};
  std::string detail = {};
  std::optional<ModelId> object = {};
  bool operator==(const Event&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"tick", &Event::tick, "of the step that caused it"}.In("tick"),
        Field{"type", &Event::type},
        Field{"robot", &Event::robot},
        Field{"other", &Event::other, "the other body, of the types that name one"},
        Field{"object", &Event::object, "the root of an object's tree"},
        Field{"detail", &Event::detail},
    };
  }
};

}  // namespace troupe
