// The messages of version 3.0 about zones as plain values: sets of zones, and a fleet control's answers to requests.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fleet/order_message.h"

namespace troupe::fleet {

enum class ZoneType : std::uint8_t {
  kBlocked,
  kLineGuided,
  kRelease,
  kCoordinatedReplanning,
  kSpeedLimit,
  kAction,
  kPriority,
  kPenalty,
  kDirected,
  kBidirected
};
constexpr auto NamesOf(ZoneType) {
  return std::array{"BLOCKED",     "LINE_GUIDED", "RELEASE",  "COORDINATED_REPLANNING",
                    "SPEED_LIMIT", "ACTION",      "PRIORITY", "PENALTY",
                    "DIRECTED",    "BIDIRECTED"};
}
enum class ZoneLoss : std::uint8_t { kStop, kContinue, kEvacuate };
constexpr auto NamesOf(ZoneLoss) {
  return std::array{"STOP", "CONTINUE", "EVACUATE"};
}
enum class DirectionLimit : std::uint8_t { kSoft, kRestricted, kStrict };
constexpr auto NamesOf(DirectionLimit) {
  return std::array{"SOFT", "RESTRICTED", "STRICT"};
}

struct ZoneVertex {
  double x = 0.0;
  double y = 0.0;

  bool operator==(const ZoneVertex&) const = default;
};

struct ZoneAction {
  std::string type;
  std::optional<std::string> descriptor;
  BlockingType blocking_type = BlockingType::kNone;
  std::optional<std::vector<ActionParameter>> parameters;
  std::optional<bool> retriable;

  bool operator==(const ZoneAction&) const = default;
};

struct Zone {
  std::string id;
  ZoneType type = ZoneType::kBlocked;
  std::optional<std::string> descriptor;
  std::vector<ZoneVertex> vertices;  // at least 3
  // Of the types that their names say.
  std::optional<ZoneLoss> release_loss_behavior;
  std::optional<double> maximum_speed;  // m/s
  std::optional<std::vector<ZoneAction>> entry_actions;
  std::optional<std::vector<ZoneAction>> during_actions;
  std::optional<std::vector<ZoneAction>> exit_actions;
  std::optional<double> priority_factor;  // from 0 to 1
  std::optional<double> penalty_factor;   // from 0 to 1
  std::optional<double> direction;        // rad
  std::optional<DirectionLimit> directed_limitation;
  std::optional<DirectionLimit> bidirected_limitation;  // SOFT or RESTRICTED

  bool operator==(const Zone&) const = default;
};

struct ZoneSet {
  Header header;
  std::string map_id;
  std::string zone_set_id;
  std::optional<std::string> descriptor;
  std::vector<Zone> zones;

  bool operator==(const ZoneSet&) const = default;
};

enum class GrantType : std::uint8_t { kGranted, kQueued, kRevoked, kRejected };
constexpr auto NamesOf(GrantType) {
  return std::array{"GRANTED", "QUEUED", "REVOKED", "REJECTED"};
}

struct RequestResponse {
  std::string request_id;
  GrantType grant_type = GrantType::kRejected;
  std::optional<std::string> lease_expiry;  // a timestamp

  bool operator==(const RequestResponse&) const = default;
};

struct Responses {
  Header header;
  std::vector<RequestResponse> responses;

  bool operator==(const Responses&) const = default;
};

}  // namespace troupe::fleet
