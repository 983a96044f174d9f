// The messages that robots send by radio: as they are proposed, and as a state keeps them until they arrive. Which
// radios receive one, and how strongly, follows from the state at its arrival: common/sensing/sensor_kinds.h.
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
  std::size_t radio = 0;           // of the robot: in RobotInfo::sensors, as in RobotDescription::sensors
  std::optional<RobotId> to = {};  // the only robot that may receive it; nothing: all in range
  std::vector<std::uint8_t> bytes = {};
  bool operator==(const RadioMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"radio", &RadioMessage::radio},
        Field{"to", &RadioMessage::to},
        Field{"bytes", &RadioMessage::bytes},
    };
  }
};

// A message on its way.
struct RadioTransmission {
  RobotId from;
  Tick sent = 0;           // the tick in which it was sent
  Tick due = 0;            // the tick in which it arrives, not before `sent`
  std::size_t number = 0;  // among the robot's messages of that tick
  RadioMessage message = {};
  bool operator==(const RadioTransmission&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"from", &RadioTransmission::from},       Field{"sent", &RadioTransmission::sent},
        Field{"due", &RadioTransmission::due},         Field{"number", &RadioTransmission::number},
        Field{"message", &RadioTransmission::message},
    };
  }
};

}  // namespace troupe
