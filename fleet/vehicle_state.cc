#include <algorithm>

#include "fleet/message_reader.h"
#include "fleet/message_writer.h"
#include "fleet/vehicle.h"

namespace troupe::fleet {
namespace {

ActionState StateOf(const TrackedAction& tracked) {
  return {tracked.action.id, tracked.action.type, tracked.action.descriptor, tracked.status, tracked.result};
}

NodeState StateOf(const Node& node) {
  NodeState state = {node.id, node.sequence_id, node.descriptor, node.released, node.position};
  if (state.position) {
    state.position->allowed_deviation_xy.reset();
    state.position->allowed_deviation_theta.reset();
  }
  return state;
}

EdgeState StateOf(const Edge& edge) {
  return {edge.id, edge.sequence_id, edge.descriptor, edge.released, edge.trajectory};
}

// The schema of 2.0 has no position without an orientation, and no control point without a weight.
void CompleteFor2_0(State& state) {
  for (NodeState& node : state.node_states) {
    if (node.position && !node.position->theta) node.position.reset();
  }
  for (EdgeState& edge : state.edge_states) {
    if (!edge.trajectory) continue;
    for (ControlPoint& point : edge.trajectory->control_points) point.weight = point.weight.value_or(1.0);
  }
}

bool HasActionZones(const Factsheet& sheet) {
  const std::optional<std::vector<std::string>>& zones = sheet.type.supported_zones;
  return zones && std::find(zones->begin(), zones->end(), NameOf(ZoneType::kAction)) != zones->end();
}

// The base is nearly used up, and there is a horizon.
bool NeedsBase(const VehicleMemory& memory, bool is_base_short) {
  if (memory.is_clearing || memory.nodes.empty() || memory.nodes.back().released) return false;
  return is_base_short || !memory.nodes.front().released;
}

}  // namespace

// The members of a memory, as texts keep it: lists beside those of messages.

template <typename Row, typename Type>
concept KeptRowOf = RowOf<Row, Type>;

template <typename Archive, KeptRowOf<ReportedError> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("error", row.error);
  a.Need("end", row.end);
}

template <typename Archive, KeptRowOf<TrackedAction> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("action", row.action);
  a.Need("scope", row.scope);
  a.Need("sequenceId", row.sequence_id);
  a.Need("released", row.is_released);
  a.Need("status", row.status);
  a.May("result", row.result);
}

template <typename Archive, KeptRowOf<StoredZoneSet> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("set", row.set);
  a.Need("status", row.status);
}

template <typename Archive, KeptRowOf<AccessRequest> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("request", row.request);
  a.May("leaseExpiry", row.lease_expiry);
}

template <typename Archive, KeptRowOf<EnteredZone> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("zoneSetId", row.zone_set_id);
  a.Need("zoneId", row.zone_id);
  a.Need("during", row.during);
}

template <typename Archive, KeptRowOf<VehicleMemory> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("orderId", row.order_id);
  a.Need("orderUpdateId", row.order_update_id);
  a.May("zoneSetId", row.zone_set_id);
  a.Need("accepted", row.accepted);
  a.Need("lastNodeId", row.last_node_id);
  a.Need("lastNodeSequenceId", row.last_node_sequence_id);
  a.Need("isAtLastNode", row.is_at_last_node);
  a.Need("isOnEdge", row.is_on_edge);
  a.Need("nodes", row.nodes);
  a.Need("edges", row.edges);
  a.Need("actions", row.actions);
  a.Need("instantActions", row.instant_actions);
  a.Need("queue", row.queue);
  a.Need("isClearing", row.is_clearing);
  a.Need("isCancelled", row.is_cancelled);
  a.Need("mode", row.mode);
  a.May("wantedMode", row.wanted_mode);
  a.Need("isDriving", row.is_driving);
  a.Need("isPaused", row.is_paused);
  a.Need("errors", row.errors);
  a.Need("maps", row.maps);
  a.Need("zoneSets", row.zone_sets);
  a.Need("requests", row.requests);
  a.Need("requestsMade", row.requests_made);
  a.Need("zoneActions", row.zone_actions);
  a.Need("zonesInside", row.zones_inside);
  a.Need("zoneActionsMade", row.zone_actions_made);
}

std::string SaveMemory(const VehicleMemory& memory) {
  std::string text;
  MessageWriter(std::nullopt, text).Write(memory);
  return text;
}

Result<VehicleMemory> RestoreMemory(std::string_view text) {
  const Result<JsonTree> tree = JsonTree::Parse(text, "", JsonLimits::OfProcesses());
  if (!tree.ok()) return tree.error();
  VehicleMemory memory;
  std::vector<MessageFault> faults;
  std::vector<LenientPlace> lenient;
  MessageReader(std::nullopt, faults, lenient).Read(tree.value().root(), memory);
  if (!faults.empty()) return BadInput("the memory of a vehicle: " + faults.front().ToString());
  return memory;
}

State MakeState(const VehicleMemory& memory, const VehicleProfile& profile, const VehicleReadings& readings) {
  State state;
  if (!memory.maps.empty()) state.maps = memory.maps;
  if (!memory.zone_sets.empty()) state.zone_sets.emplace();
  for (const StoredZoneSet& stored : memory.zone_sets) {
    state.zone_sets->push_back({stored.set.zone_set_id, stored.set.map_id, stored.status});
  }
  if (!memory.requests.empty()) state.zone_requests.emplace();
  for (const AccessRequest& access : memory.requests) state.zone_requests->push_back(access.request);
  state.order_id = memory.order_id;
  state.order_update_id = memory.order_update_id;
  state.zone_set_id = memory.zone_set_id;
  state.last_node_id = memory.last_node_id;
  state.last_node_sequence_id = memory.last_node_sequence_id;
  for (const Node& node : memory.nodes) state.node_states.push_back(StateOf(node));
  for (const Edge& edge : memory.edges) state.edge_states.push_back(StateOf(edge));
  if (profile.version == Version::k2_0) CompleteFor2_0(state);
  state.planned_path = readings.planned_path;
  state.intermediate_path = readings.intermediate_path;
  state.position = readings.position;
  state.velocity = readings.velocity;
  state.loads = readings.loads;
  state.driving = memory.is_driving;
  state.paused = memory.is_paused;
  state.new_base_request = NeedsBase(memory, readings.is_base_short);
  state.distance_since_last_node = readings.distance_since_last_node;
  for (const TrackedAction& tracked : memory.actions) state.action_states.push_back(StateOf(tracked));
  std::vector<ActionState>& instant = IsBefore3(profile.version) ? state.action_states : state.instant_action_states;
  for (const TrackedAction& tracked : memory.instant_actions) instant.push_back(StateOf(tracked));
  if (HasActionZones(profile.factsheet) || !memory.zone_actions.empty()) state.zone_action_states.emplace();
  for (const TrackedAction& tracked : memory.zone_actions) state.zone_action_states->push_back(StateOf(tracked));
  state.power_supply = readings.power_supply;
  state.operating_mode = memory.mode;
  for (const ReportedError& reported : memory.errors) state.errors.push_back(reported.error);
  state.safety_state = readings.safety_state;
  return state;
}

std::vector<std::string_view> ReasonsToSend(const State& last, const State& now) {
  std::vector<std::string_view> reasons;
  const auto add_if = [&](bool differs, std::string_view member) {
    if (differs) reasons.push_back(member);
  };
  add_if(last.order_id != now.order_id, "orderId");
  add_if(last.order_update_id != now.order_update_id, "orderUpdateId");
  add_if(last.last_node_id != now.last_node_id || last.last_node_sequence_id != now.last_node_sequence_id,
         "lastNodeId");
  add_if(last.node_states != now.node_states, "nodeStates");
  add_if(last.edge_states != now.edge_states, "edgeStates");
  add_if(last.action_states != now.action_states, "actionStates");
  add_if(last.instant_action_states != now.instant_action_states, "instantActionStates");
  add_if(last.zone_action_states != now.zone_action_states, "zoneActionStates");
  add_if(last.loads != now.loads, "loads");
  add_if(last.errors != now.errors, "errors");
  add_if(last.operating_mode != now.operating_mode, "operatingMode");
  add_if(last.driving != now.driving, "driving");
  add_if(last.paused != now.paused, "paused");
  add_if(last.new_base_request != now.new_base_request, "newBaseRequest");
  add_if(last.safety_state != now.safety_state, "safetyState");
  add_if(last.power_supply.charging != now.power_supply.charging, "charging");
  add_if(last.maps != now.maps, "maps");
  add_if(last.zone_sets != now.zone_sets, "zoneSets");
  add_if(last.zone_requests != now.zone_requests, "zoneRequests");
  add_if(last.edge_requests != now.edge_requests, "edgeRequests");
  return reasons;
}

bool IsStateDue(const State& last, std::int64_t last_milliseconds, const State& now, std::int64_t now_milliseconds,
                const TimingLimits& timing) {
  const double passed = static_cast<double>(now_milliseconds - last_milliseconds) / 1000.0;
  const double longest = std::min(timing.default_state_interval.value_or(kLongestStateInterval), kLongestStateInterval);
  if (passed >= longest) return true;
  return passed >= timing.minimum_state_interval && !ReasonsToSend(last, now).empty();
}

}  // namespace troupe::fleet
