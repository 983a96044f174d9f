// FleetMessage: what a fleet control and a vehicle tell each other, by VDA 5050 (docs/vda5050.md). To a vehicle it is
// an input of the tick that it arrives in; from a vehicle it is a part of its proposal. So both are in recordings.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>

#include "troupe/enum_names.h"
#include "troupe/fields.h"

namespace troupe {

enum class FleetTopic : std::uint8_t {
  kOrder,  // these four are to vehicles
  kInstantActions,
  kZoneSet,
  kResponses,
  kState,  // and these of vehicles
  kVisualization,
  kFactsheet,
};
constexpr auto NamesOf(FleetTopic) {
  return std::array{"order", "instantActions", "zoneSet", "responses", "state", "visualization", "factsheet"};
}
constexpr bool IsToVehicle(FleetTopic topic) {
  return topic < FleetTopic::kState;
}

struct FleetMessage {
  FleetTopic topic = FleetTopic::kOrder;
  std::string text = {};  // UTF-8: JSON, or what a peer sent in its place
  bool operator==(const FleetMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"topic", &FleetMessage::topic},
        Field{"text", &FleetMessage::text},
    };
  }
};

// Of one robot in one tick, to it and from it.
inline constexpr std::size_t kMaxFleetMessages = 16;
inline constexpr std::size_t kMaxFleetBytes = std::size_t{256} << 10;  // of one text

}  // namespace troupe
