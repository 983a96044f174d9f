// Event: something worth telling that happened at a tick. Steps return them in a fixed order.
#pragma once

#include <optional>
#include <string>

#include "common/base/ids.h"

namespace troupe {

enum class EventType : std::uint8_t {
  kStallBegan = 0,        // the robot's motion was cut short; `other` is the model it met, none for the ground
  kStallEnded = 1,        // it moves freely again
  kJoined = 2,            // an agent took the robot up
  kLeft = 3,              // the robot's agent left or was lost
  kProposalRejected = 4,  // `detail` says why
  kBlocked = 5,   // a joint's motion was cut short; `detail` names it, `other` is what it met, none for the ground
  kGripped = 6,   // the robot's gripper, named by `detail`, holds `object` from now on
  kReleased = 7,  // it has let `object` go
  kLanded = 8,    // `object` came to rest on `other`, none for the ground
  kUnstable = 9,  // likewise, but its centre is not over what carries it
};

struct Event {
  Tick tick = 0;
  EventType type = EventType::kStallBegan;
  std::optional<RobotId> robot = {};
  std::optional<ModelId> other = {};
  std::string detail = {};
  std::optional<ModelId> object = {};  // the root of an object's tree
  bool operator==(const Event&) const = default;
};

// "stall_began", ...
const char* ToString(EventType type);

}  // namespace troupe
