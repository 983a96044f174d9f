// A vehicle's side of VDA 5050 as a pure state machine: what it remembers of its order (VehicleMemory), what happens to
// it (VehicleInput), and what follows (Apply). No clock, no messages, no motion: a controller drives to the next node,
// works on the actions that are started, and tells what has happened.
//
// The memory is a plain value: a copy of it continues in the same way, and SaveMemory and RestoreMemory keep it as
// text. What a controller has to do follows from the memory alone: drive if MayDrive, to the first of `nodes`; work on
// every action that is INITIALIZING or RUNNING; do nothing for the others.
//
// Where the standard leaves a choice:
// - Instant actions start at once, whatever runs. While one runs that is no pause or cancel, its blocking type counts.
// - Actions of an edge that still run when its end is reached become FINISHED; a controller reports a failure before.
// - Nothing starts while the vehicle is paused, or while an error of level CRITICAL or FATAL is reported.
// - The content of a stitching node is that of the order that the vehicle already has.
// - An instant action whose id is known is a resend and has no effect.
// - A cancelled order leaves the actions of zones as they are. A mode that clears the order ends them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fleet/codec.h"
#include "fleet/factsheet_message.h"
#include "fleet/order_message.h"
#include "fleet/order_table.h"
#include "fleet/state_message.h"
#include "fleet/zone_message.h"
#include "troupe/result.h"

namespace troupe::fleet {

// What does not change during a run.
struct VehicleProfile {
  Version version = Version::k2_1;
  Factsheet factsheet;
  bool stops_between_nodes = true;  // else a cancelled order ends at the next node
  double node_tolerance = 0.1;      // m, the vehicle's own: for nodes without a deviation
};

// The end of an error that the state machine reports.
enum class ErrorEnd : std::uint8_t {
  kCause,          // ErrorCleared
  kOrder,          // an order or an update is accepted
  kNewOrder,       // a new order is accepted
  kInstantAction,  // an instant action is accepted
};
constexpr auto NamesOf(ErrorEnd) {
  return std::array{"cause", "order", "new_order", "instant_action"};
}

struct ReportedError {
  VehicleError error;
  ErrorEnd end = ErrorEnd::kCause;

  bool operator==(const ReportedError&) const = default;
};

struct TrackedAction {
  Action action;
  ActionScope scope = ActionScope::kNode;
  std::uint32_t sequence_id = 0;  // of its node or edge
  bool is_released = false;       // of the base
  ActionStatus status = ActionStatus::kWaiting;
  std::optional<std::string> result;

  bool operator==(const TrackedAction&) const = default;
};

// A set of zones that the vehicle has (3.0).
struct StoredZoneSet {
  ZoneSet set;
  StoredStatus status = StoredStatus::kDisabled;

  bool operator==(const StoredZoneSet&) const = default;
};

// An ACTION zone that the vehicle is in (3.0).
struct EnteredZone {
  std::string zone_set_id;
  std::string zone_id;
  std::vector<std::string> during;  // ids of its actions that end when it is left

  bool operator==(const EnteredZone&) const = default;
};

// A request to enter a zone of an enabled set, or to drive a path there (3.0).
struct AccessRequest {
  ZoneRequest request;
  std::optional<std::string> lease_expiry;  // a timestamp; nothing: a grant has no end

  bool operator==(const AccessRequest&) const = default;
};

struct VehicleMemory {
  std::string order_id;  // of the present or the last order
  std::uint32_t order_update_id = 0;
  std::optional<std::string> zone_set_id;
  Order accepted;  // the message that was accepted last
  std::string last_node_id;
  std::uint32_t last_node_sequence_id = 0;
  bool is_at_last_node = false;  // it has not left it
  bool is_on_edge = false;       // it has entered the first of `edges`
  std::vector<Node> nodes;       // still to be traversed
  std::vector<Edge> edges;       // edge i leads to node i
  std::vector<TrackedAction> actions;
  std::vector<TrackedAction> instant_actions;
  std::vector<std::string> queue;  // ids of actions that are triggered and wait for others, in their sequence
  bool is_clearing = false;        // the order is being cancelled
  bool is_cancelled = false;
  OperatingMode mode = OperatingMode::kAutomatic;
  std::optional<OperatingMode> wanted_mode;  // reported once the order is cleared
  bool is_driving = false;
  bool is_paused = false;
  std::vector<ReportedError> errors;
  std::vector<MapState> maps;
  std::vector<StoredZoneSet> zone_sets;  // 3.0, as the following
  std::vector<AccessRequest> requests;
  std::uint32_t requests_made = 0;
  std::vector<TrackedAction> zone_actions;  // until they are cleared
  std::vector<EnteredZone> zones_inside;
  std::uint32_t zone_actions_made = 0;

  bool operator==(const VehicleMemory&) const = default;
};

std::string SaveMemory(const VehicleMemory& memory);
Result<VehicleMemory> RestoreMemory(std::string_view text);

// What the vehicle measures, for its state.
struct VehicleReadings {
  std::optional<RobotPosition> position;
  std::optional<Velocity> velocity;
  std::optional<std::vector<Load>> loads;
  std::optional<double> distance_since_last_node;
  PowerSupply power_supply;
  SafetyState safety_state;
  std::optional<PlannedPath> planned_path;
  std::optional<IntermediatePath> intermediate_path;
  bool is_base_short = false;  // it will have to brake for the end of the base

  bool operator==(const VehicleReadings&) const = default;
};

// Inputs. Of a message with faults as much as could be read.
struct OrderReceived {
  Order order;
  std::vector<MessageFault> faults;
};
struct InstantActionsReceived {
  InstantActions message;
  std::vector<MessageFault> faults;
};
// Of 3.0.
struct ZoneSetReceived {
  ZoneSet set;
  std::vector<MessageFault> faults;
};
struct ResponsesReceived {
  Responses message;
  std::vector<MessageFault> faults;
};
// A zone is on its way that it may enter with a grant only: it asks for one, if it has not.
struct AccessWanted {
  std::string zone_set_id;
  std::string zone_id;
  std::optional<Trajectory> path = {};  // that it wants to drive there (REPLANNING); nothing: ACCESS
};
// It has left the zone, or does not go there any more.
struct AccessEnded {
  std::string request_id;
};
// The lease of a grant is over.
struct LeaseEnded {
  std::string request_id;
};
// It has entered, or left, an ACTION zone of an enabled set.
struct ZoneEntered {
  std::string zone_set_id;
  std::string zone_id;
};
struct ZoneLeft {
  std::string zone_set_id;
  std::string zone_id;
};
// The vehicle has traversed the first of `nodes`.
struct NodeReached {
  std::uint32_t sequence_id = 0;
};
// A started action is RUNNING, PAUSED, FINISHED or FAILED. A failed one that may be tried again becomes RETRIABLE
// (3.0).
struct ActionProgress {
  std::string action_id;
  ActionStatus status = ActionStatus::kRunning;
  std::optional<std::string> result;
  std::optional<VehicleError> error;  // its cause; ends with the order
};
struct DrivingChanged {
  bool is_driving = false;
};
// A person has taken the vehicle over, or has given it back. A mode that clears the order is reported once that is
// done, and a change back to one that keeps orders has no effect before: it has to be given again.
struct ModeChanged {
  OperatingMode mode = OperatingMode::kAutomatic;
};
// A button at the vehicle.
struct PauseChanged {
  bool is_paused = false;
};
// It has been moved to a place where it cannot continue.
struct LastNodeLost {};
// In place of an error of that type with the same references.
struct ErrorRaised {
  VehicleError error;
};
// All errors of that type that were raised.
struct ErrorCleared {
  std::string type;
};
using VehicleInput = std::variant<OrderReceived, InstantActionsReceived, NodeReached, ActionProgress, DrivingChanged,
                                  ModeChanged, PauseChanged, LastNodeLost, ErrorRaised, ErrorCleared, ZoneSetReceived,
                                  ResponsesReceived, AccessWanted, AccessEnded, LeaseEnded, ZoneEntered, ZoneLeft>;

struct VehicleOutcome {
  const OrderRow* row = nullptr;  // of an order: the row that has decided
  bool must_send_state = false;   // asked for
  bool must_send_factsheet = false;
};

// Changes the memory by an input. An input that does not fit (a node that is not next, an action that is not started)
// has no effect.
VehicleOutcome Apply(VehicleMemory& memory, const VehicleInput& input, const VehicleProfile& profile,
                     const VehicleReadings& readings);

OrderFacts FactsOf(const VehicleMemory& memory, const OrderReceived& received, const VehicleProfile& profile,
                   const VehicleReadings& readings);

// The order has nodes, edges or actions left, or is being cancelled.
bool IsBusy(const VehicleMemory& memory);
// The vehicle may move to the first of `nodes`.
bool MayDrive(const VehicleMemory& memory, const VehicleProfile& profile);

// The state that the vehicle reports, without a header.
State MakeState(const VehicleMemory& memory, const VehicleProfile& profile, const VehicleReadings& readings);

// The differences of two states for which the standard wants a message, by the names of members.
std::vector<std::string_view> ReasonsToSend(const State& last, const State& now);

// Whether a state is due: a reason and the minimum interval has passed, or the longest interval has.
bool IsStateDue(const State& last, std::int64_t last_milliseconds, const State& now, std::int64_t now_milliseconds,
                const TimingLimits& timing);

inline constexpr double kLongestStateInterval = 30.0;  // s

}  // namespace troupe::fleet
