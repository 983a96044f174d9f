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
};

struct Event {
  Tick tick = 0;
  EventType type = EventType::kStallBegan;
  std::optional<RobotId> robot;
  std::optional<ModelId> other;
  std::string detail;
  bool operator==(const Event&) const = default;
};

// "stall_began", ...
const char* ToString(EventType type);

}  // namespace troupe
