// The topics of MQTT that VDA 5050 uses: INTERFACE/vMAJOR/MANUFACTURER/SERIAL_NUMBER/TOPIC.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "fleet/order_message.h"

namespace troupe::fleet {

enum class Topic : std::uint8_t {
  kOrder,
  kInstantActions,
  kState,
  kConnection,
  kFactsheet,
  kVisualization,
  kZoneSet,
  kResponses
};
constexpr auto NamesOf(Topic) {
  return std::array{"order",     "instantActions", "state",   "connection",
                    "factsheet", "visualization",  "zoneSet", "responses"};
}

// 2 or 3.
int MajorOf(Version version);

struct TopicName {
  std::string interface_name;  // may have several levels, or none
  int major_version = 2;
  std::string manufacturer;
  std::string serial_number;
  Topic topic = Topic::kState;

  std::string ToString() const;

  bool operator==(const TopicName&) const = default;
};

// Nothing for other topics.
std::optional<TopicName> FindTopic(std::string_view text);

}  // namespace troupe::fleet
