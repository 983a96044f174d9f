// The messages that robots send by radio: as they are proposed, and as a state keeps them until they arrive. Which
// radios receive one, and how strongly, follows from the state at its arrival: common/sensing/sensor_kinds.h.
//
// Limits hold per tick and robot, so that frames and memory have a bound in the number of robots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "troupe/fields.h"
#include "troupe/ids.h"

namespace troupe {

inline constexpr std::size_t kMaxRadioBytes = 16'384;  // that one radio sends in a tick, of all its messages
inline constexpr std::size_t kMaxRadioMessages = 64;   // that one robot sends in a tick

// A message that a robot is to send in its next tick.
struct RadioMessage {
  std::size_t radio = 0;
  std::optional<RobotId> to = {};
  std::vector<std::uint8_t> bytes = {};
  bool operator==(const RadioMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"radio", &RadioMessage::radio, "the sensor, in RobotInfo::sensors as in RobotDescription::sensors"},
        Field{"to", &RadioMessage::to, "the only robot that may receive it; none: all in range"},
        Field{"bytes", &RadioMessage::bytes},
    };
  }
};

// A message on its way.
struct RadioTransmission {
  RobotId from;
  Tick sent = 0;
  Tick due = 0;
  std::size_t number = 0;
  RadioMessage message = {};
  bool operator==(const RadioTransmission&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"from", &RadioTransmission::from},
        Field{"sent", &RadioTransmission::sent, "the tick in which it was sent"}.In("tick"),
        Field{"due", &RadioTransmission::due, "the tick in which it arrives, not before `sent`"}.In("tick"),
        Field{"number", &RadioTransmission::number, "among the robot's messages of that tick"},
        Field{"message", &RadioTransmission::message},
    };
  }
};

}  // namespace troupe
