// The messages of a vehicle of VDA 5050 as plain values: its state, its position for viewers, and its connection.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fleet/order_message.h"

namespace troupe::fleet {

// RETRIABLE is new in 3.0.
enum class ActionStatus : std::uint8_t { kWaiting, kInitializing, kRunning, kPaused, kRetriable, kFinished, kFailed };
constexpr auto NamesOf(ActionStatus) {
  return std::array{"WAITING", "INITIALIZING", "RUNNING", "PAUSED", "RETRIABLE", "FINISHED", "FAILED"};
}
constexpr bool IsFinal(ActionStatus status) {
  return status == ActionStatus::kFinished || status == ActionStatus::kFailed;
}
constexpr bool IsStarted(ActionStatus status) {
  return status != ActionStatus::kWaiting && !IsFinal(status);
}

struct ActionState {
  std::string action_id;
  std::optional<std::string> action_type;
  std::optional<std::string> descriptor;
  ActionStatus status = ActionStatus::kWaiting;
  std::optional<std::string> result;

  bool operator==(const ActionState&) const = default;
};

struct NodeState {
  std::string node_id;
  std::uint32_t sequence_id = 0;
  std::optional<std::string> descriptor;
  bool released = false;
  std::optional<NodePosition> position;  // without deviations

  bool operator==(const NodeState&) const = default;
};

struct EdgeState {
  std::string edge_id;
  std::uint32_t sequence_id = 0;
  std::optional<std::string> descriptor;
  bool released = false;
  std::optional<Trajectory> trajectory;

  bool operator==(const EdgeState&) const = default;
};

struct RobotPosition {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;
  std::string map_id;
  std::optional<std::string> map_descriptor;  // until 2.1
  bool localized = false;
  std::optional<double> localization_score;  // from 0 to 1
  std::optional<double> deviation_range;     // m

  bool operator==(const RobotPosition&) const = default;
};

// In the frame of the vehicle.
struct Velocity {
  std::optional<double> vx;  // m/s
  std::optional<double> vy;
  std::optional<double> omega;  // rad/s

  bool operator==(const Velocity&) const = default;
};

// The centre of the bottom of a load's box, in the frame of the vehicle.
struct BoundingBoxReference {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  std::optional<double> theta;

  bool operator==(const BoundingBoxReference&) const = default;
};

struct LoadDimensions {
  double length = 0.0;  // m
  double width = 0.0;
  std::optional<double> height;

  bool operator==(const LoadDimensions&) const = default;
};

struct Load {
  std::optional<std::string> id;  // empty: not identified
  std::optional<std::string> type;
  std::optional<std::string> position;  // the name of the device that carries it
  std::optional<BoundingBoxReference> bounding_box_reference;
  std::optional<LoadDimensions> dimensions;
  std::optional<double> weight;  // kg

  bool operator==(const Load&) const = default;
};

struct PowerSupply {
  double state_of_charge = 0.0;  // from 0 to 100
  std::optional<double> battery_voltage;
  std::optional<double> battery_current;  // 3.0
  std::optional<double> battery_health;   // from 0 to 100
  bool charging = false;
  std::optional<double> range;  // m

  bool operator==(const PowerSupply&) const = default;
};

// INTERVENED and STARTUP are new in 3.0.
enum class OperatingMode : std::uint8_t {
  kAutomatic,
  kSemiautomatic,
  kIntervened,
  kManual,
  kStartup,
  kService,
  kTeachIn
};
constexpr auto NamesOf(OperatingMode) {
  return std::array{"AUTOMATIC", "SEMIAUTOMATIC", "INTERVENED", "MANUAL", "STARTUP", "SERVICE", "TEACH_IN"};
}

// URGENT and CRITICAL are new in 3.0. WARNING, URGENT: the order goes on. CRITICAL: it does not; a new one is accepted.
// FATAL: neither.
enum class ErrorLevel : std::uint8_t { kWarning, kUrgent, kCritical, kFatal };
constexpr auto NamesOf(ErrorLevel) {
  return std::array{"WARNING", "URGENT", "CRITICAL", "FATAL"};
}

struct Reference {
  std::string key;
  std::string value;

  bool operator==(const Reference&) const = default;
};

struct Translation {
  std::string key;  // ISO 639-1
  std::string value;

  bool operator==(const Translation&) const = default;
};

struct VehicleError {
  std::string type;
  std::optional<std::vector<Reference>> references;
  std::optional<std::string> description;
  std::optional<std::vector<Translation>> description_translations;  // 3.0
  std::optional<std::string> hint;
  std::optional<std::vector<Translation>> hint_translations;  // 3.0
  ErrorLevel level = ErrorLevel::kWarning;

  bool operator==(const VehicleError&) const = default;
};

enum class InfoLevel : std::uint8_t { kInfo, kDebug };
constexpr auto NamesOf(InfoLevel) {
  return std::array{"INFO", "DEBUG"};
}

struct Information {
  std::string type;
  std::optional<std::vector<Reference>> references;
  std::optional<std::string> descriptor;
  InfoLevel level = InfoLevel::kInfo;

  bool operator==(const Information&) const = default;
};

// AUTOACK exists until 2.1.
enum class EmergencyStop : std::uint8_t { kNone, kAutomatic, kManual, kRemote };
constexpr auto NamesOf(EmergencyStop) {
  return std::array{"NONE", "AUTOACK", "MANUAL", "REMOTE"};
}

struct SafetyState {
  EmergencyStop emergency_stop = EmergencyStop::kNone;
  bool field_violation = false;

  bool operator==(const SafetyState&) const = default;
};

enum class StoredStatus : std::uint8_t { kEnabled, kDisabled };
constexpr auto NamesOf(StoredStatus) {
  return std::array{"ENABLED", "DISABLED"};
}

struct MapState {
  std::string map_id;
  std::string version;
  std::optional<std::string> descriptor;
  StoredStatus status = StoredStatus::kDisabled;

  bool operator==(const MapState&) const = default;
};

struct ZoneSetState {
  std::string zone_set_id;
  std::string map_id;
  StoredStatus status = StoredStatus::kDisabled;

  bool operator==(const ZoneSetState&) const = default;
};

struct PlannedPath {
  Trajectory trajectory;
  std::optional<std::vector<std::string>> traversed_nodes;

  bool operator==(const PlannedPath&) const = default;
};

struct Waypoint {
  double x = 0.0;
  double y = 0.0;
  std::optional<double> theta;
  std::string eta;  // a timestamp

  bool operator==(const Waypoint&) const = default;
};

struct IntermediatePath {
  std::vector<Waypoint> polyline;

  bool operator==(const IntermediatePath&) const = default;
};

enum class RequestStatus : std::uint8_t { kRequested, kGranted, kRevoked, kExpired, kQueued };
constexpr auto NamesOf(RequestStatus) {
  return std::array{"REQUESTED", "GRANTED", "REVOKED", "EXPIRED", "QUEUED"};
}
enum class ZoneRequestType : std::uint8_t { kAccess, kReplanning };
constexpr auto NamesOf(ZoneRequestType) {
  return std::array{"ACCESS", "REPLANNING"};
}
enum class EdgeRequestType : std::uint8_t { kCorridor };
constexpr auto NamesOf(EdgeRequestType) {
  return std::array{"CORRIDOR"};
}

struct ZoneRequest {
  std::string id;
  ZoneRequestType type = ZoneRequestType::kAccess;
  std::string zone_id;
  std::string zone_set_id;
  RequestStatus status = RequestStatus::kRequested;
  std::optional<Trajectory> trajectory;

  bool operator==(const ZoneRequest&) const = default;
};

struct EdgeRequest {
  std::string id;
  EdgeRequestType type = EdgeRequestType::kCorridor;
  std::string edge_id;
  std::uint32_t sequence_id = 0;
  RequestStatus status = RequestStatus::kRequested;

  bool operator==(const EdgeRequest&) const = default;
};

struct State {
  Header header;
  std::optional<std::vector<MapState>> maps;
  std::optional<std::vector<ZoneSetState>> zone_sets;  // 3.0
  std::string order_id;                                // of the present or last order; empty: none yet
  std::uint32_t order_update_id = 0;
  std::optional<std::string> zone_set_id;  // until 2.1
  std::string last_node_id;                // empty: none
  std::uint32_t last_node_sequence_id = 0;
  std::vector<NodeState> node_states;  // still to be traversed
  std::vector<EdgeState> edge_states;
  std::optional<PlannedPath> planned_path;            // 3.0
  std::optional<IntermediatePath> intermediate_path;  // 3.0
  std::optional<RobotPosition> position;
  std::optional<Velocity> velocity;
  std::optional<std::vector<Load>> loads;  // missing: unknown
  bool driving = false;
  std::optional<bool> paused;
  std::optional<bool> new_base_request;
  std::optional<std::vector<ZoneRequest>> zone_requests;  // 3.0
  std::optional<std::vector<EdgeRequest>> edge_requests;  // 3.0
  std::optional<double> distance_since_last_node;
  std::vector<ActionState> action_states;                      // until 2.1 with instant actions
  std::vector<ActionState> instant_action_states;              // 3.0
  std::optional<std::vector<ActionState>> zone_action_states;  // 3.0
  PowerSupply power_supply;
  OperatingMode operating_mode = OperatingMode::kAutomatic;
  std::vector<VehicleError> errors;
  std::optional<std::vector<Information>> information;
  SafetyState safety_state;

  bool operator==(const State&) const = default;
};

struct Visualization {
  Header header;
  std::uint32_t reference_state_header_id = 0;        // 3.0
  std::optional<PlannedPath> planned_path;            // 3.0
  std::optional<IntermediatePath> intermediate_path;  // 3.0
  std::optional<RobotPosition> position;
  std::optional<Velocity> velocity;

  bool operator==(const Visualization&) const = default;
};

// HIBERNATING is new in 3.0.
enum class ConnectionState : std::uint8_t { kOnline, kOffline, kHibernating, kConnectionBroken };
constexpr auto NamesOf(ConnectionState) {
  return std::array{"ONLINE", "OFFLINE", "HIBERNATING", "CONNECTION_BROKEN"};
}

struct Connection {
  Header header;
  ConnectionState state = ConnectionState::kOffline;

  bool operator==(const Connection&) const = default;
};

}  // namespace troupe::fleet
