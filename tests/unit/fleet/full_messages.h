// Messages of VDA 5050 with every member that a version has, and with as few as possible.
#pragma once

#include <string>
#include <vector>

#include "fleet/codec.h"
#include "tests/unit/fleet/fleet_samples.h"

namespace troupe::fleet {

inline constexpr Version kAllVersions[] = {Version::k2_0, Version::k2_1, Version::k3_0};

inline Trajectory SampleCurve() {
  return {2, std::vector<double>{0, 0, 0, 1, 1, 1}, {{0, 0, 1.0}, {1, 1, 2.0}, {2, 0, 0.5}}};
}

// An order with every member that the version has.
inline Order FullOrder(Version version) {
  Order order = SampleOrder(version, "o1", 3, "ABC", 2);
  Node& node = order.nodes[1];
  node.descriptor = "a \"node\" \xc3\xa9";
  node.position->theta = -1.5;
  node.position->allowed_deviation_xy = AllowedDeviation{0.3, 0.3, 0.0};
  node.position->allowed_deviation_theta = 0.2;
  Action action = SampleActionOf("pick", "a1", BlockingType::kSoft);
  action.descriptor = "lift it";
  action.parameters = {{{"height", ParameterValue::Of(0.1)},
                        {"lhd", ParameterValue::Of("front")},
                        {"fast", {ParameterValue::Kind::kBoolean, "true"}},
                        {"list", {ParameterValue::Kind::kJson, "[1,{\"a\":\"b\"},null]"}}}};
  node.actions = {action};
  Edge& edge = order.edges[0];
  edge.descriptor = "an edge";
  edge.maximum_speed = 1.25;
  edge.maximum_robot_height = 2.0;
  edge.minimum_device_height = 0.5;
  edge.orientation = 3.0;
  edge.orientation_type = OrientationType::kTangential;
  edge.direction = "left";
  edge.maximum_rotation_speed = 0.5;
  edge.length = 4.0;
  edge.trajectory = SampleCurve();
  edge.corridor = Corridor{0.5, 0.75, CorridorReference::kKinematicCenter, {}, {}};
  edge.actions = {SampleActionOf("blink", "a2", BlockingType::kNone)};
  if (IsBefore3(version)) {
    order.zone_set_id = "zones";
    edge.rotation_allowed = false;
    node.position->map_descriptor = "floor";
  } else {
    order.descriptor = "an order";
    edge.reach_orientation_before_entering = true;
    edge.corridor->release_required = true;
    edge.corridor->release_loss_behavior = CorridorLoss::kReturn;
    node.position->allowed_deviation_xy = AllowedDeviation{0.3, 0.2, 0.5};
    node.actions[0].retriable = true;
    node.actions[0].blocking_type = BlockingType::kSingle;
  }
  return order;
}

inline State FullState(Version version) {
  const bool is_3 = !IsBefore3(version);
  State state;
  state.header = SampleHeader(version, 7);
  state.maps = {{{"L1", "1", "floor", StoredStatus::kEnabled}}};
  state.order_id = "o1";
  state.order_update_id = 3;
  state.last_node_id = "A";
  state.node_states = {{"B", 2, "b", true, NodePosition{4, 0, 1.0, {}, {}, "L1", {}}}, {"C", 4, {}, false, {}}};
  state.edge_states = {{"AB", 1, {}, true, SampleCurve()}, {"BC", 3, {}, false, {}}};
  state.position = RobotPosition{0.5, 0.25, -3.0, "L1", {}, true, 0.75, 0.125};
  state.velocity = Velocity{0.5, 0.0, -0.25};
  state.loads = {{{"box", "EPAL", "front", BoundingBoxReference{0, 0, 0.5, 0.1}, LoadDimensions{1, 0.5, 0.5}, 20.0}}};
  state.driving = true;
  state.paused = false;
  state.new_base_request = true;
  state.distance_since_last_node = 0.5;
  state.action_states = {{"a1", "pick", "lift it", ActionStatus::kRunning, {}},
                         {"a2", "blink", {}, ActionStatus::kFailed, "no lamp"}};
  state.power_supply = {80.5, 24.0, {}, 99.0, true, 1000.0};
  state.operating_mode = OperatingMode::kSemiautomatic;
  state.errors = {{"orderError", {{{"orderId", "o2"}}}, "why", {}, "try it", {}, ErrorLevel::kWarning}};
  state.information = {{{"debug", {{{"a", "b"}}}, "text", InfoLevel::kDebug}}};
  state.safety_state = {EmergencyStop::kManual, true};
  if (is_3) {
    state.zone_sets = {{{"z", "L1", StoredStatus::kDisabled}}};
    state.planned_path = PlannedPath{SampleCurve(), {{"B"}}};
    state.intermediate_path = IntermediatePath{{{0, 0, 0.5, "1970-01-01T00:00:05.000Z"}}};
    state.zone_requests = {{{"r1", ZoneRequestType::kAccess, "zone", "z", RequestStatus::kGranted, {}}}};
    state.edge_requests = {{{"r2", EdgeRequestType::kCorridor, "AB", 1, RequestStatus::kRequested}}};
    state.instant_action_states = {{"i1", "startPause", {}, ActionStatus::kFinished, {}}};
    state.zone_action_states.emplace();
    state.power_supply.battery_current = -1.5;
    state.operating_mode = OperatingMode::kIntervened;
    state.errors[0].level = ErrorLevel::kCritical;
    state.errors[0].hint_translations = {{{"de", "versuche es"}}};
    state.action_states[0].status = ActionStatus::kRetriable;
  } else {
    state.zone_set_id = "zones";
    state.position->map_descriptor = "floor";
  }
  return state;
}

inline Factsheet FullFactsheet(Version version) {
  Factsheet sheet = SampleFactsheet(version);
  sheet.type.series_description = "a sample";
  sheet.limits.strings.message = 100'000;
  sheet.limits.strings.id_numerical_only = false;
  sheet.limits.arrays.order_nodes = 100;
  sheet.limits.arrays.information_references = 5;
  sheet.limits.timing.default_state_interval = 10.0;
  sheet.geometry.wheels = {{{"DRIVE", true, false, {0, 0.2, {}}, 0.1, 0.05, 0.0, "none"}}};
  sheet.geometry.envelopes = {{{"body", {{0, 0}, {1, 0}, {1, 1}}, "outline"}}};
  sheet.load.load_positions = {{"front"}};
  LoadSet set;
  set.name = "pallets";
  set.load_type = "EPAL";
  set.load_positions = {{"front"}};
  set.dimensions = LoadDimensions{1.2, 0.8, {}};
  set.maximum_weight = 500.0;
  set.maximum_speed = 0.8;
  set.pick_time = 3.5;
  sheet.load.load_sets = {{set}};
  sheet.configuration.emplace();
  sheet.configuration->versions = {{{"troupe", "1"}}};
  if (!IsBefore3(version)) {
    sheet.type.supported_zones = {{"BLOCKED"}};
    sheet.limits.arrays.instant_action_states = 50;
    sheet.configuration->battery_charging = BatteryCharging{10.0, 20.0, 90.0, 60.0};
  } else {
    // 2.x does not say it.
    for (ActionSpecification& action : sheet.features.actions) action.pause_allowed = action.cancel_allowed = false;
  }
  return sheet;
}

inline ZoneSet FullZoneSet() {
  ZoneSet set;
  set.header = SampleHeader(Version::k3_0);
  set.map_id = "L1";
  set.zone_set_id = "z";
  set.descriptor = "zones";
  const std::vector<ZoneVertex> corner = {{0, 0}, {1, 0}, {0, 1}};
  for (const ZoneType type : {ZoneType::kBlocked, ZoneType::kLineGuided, ZoneType::kRelease,
                              ZoneType::kCoordinatedReplanning, ZoneType::kSpeedLimit, ZoneType::kAction,
                              ZoneType::kPriority, ZoneType::kPenalty, ZoneType::kDirected, ZoneType::kBidirected}) {
    Zone zone;
    zone.id = NameOf(type);
    zone.type = type;
    zone.vertices = corner;
    if (type == ZoneType::kRelease) zone.release_loss_behavior = ZoneLoss::kEvacuate;
    if (type == ZoneType::kSpeedLimit) zone.maximum_speed = 0.5;
    if (type == ZoneType::kAction) {
      zone.entry_actions = {{{"blink", {}, BlockingType::kNone, {}, {}}}};
      zone.during_actions.emplace();
      zone.exit_actions.emplace();
    }
    if (type == ZoneType::kPriority) zone.priority_factor = 0.5;
    if (type == ZoneType::kPenalty) zone.penalty_factor = 1.0;
    if (type == ZoneType::kDirected || type == ZoneType::kBidirected) zone.direction = 1.0;
    if (type == ZoneType::kDirected) zone.directed_limitation = DirectionLimit::kStrict;
    if (type == ZoneType::kBidirected) zone.bidirected_limitation = DirectionLimit::kSoft;
    set.zones.push_back(zone);
  }
  return set;
}

struct NamedPayload {
  std::string topic;
  Version version;
  std::string text;
};

inline std::vector<NamedPayload> AllPayloads() {
  std::vector<NamedPayload> payloads;
  for (const Version version : kAllVersions) {
    const auto add = [&](const std::string& topic, const auto& message) {
      payloads.push_back({topic, version, Encode(message, version)});
    };
    add("order", FullOrder(version));
    add("order", SampleOrder(version, "o2", 0, "A", 1));
    add("instantActions",
        InstantActions{SampleHeader(version), {SampleActionOf("cancelOrder", "i1", BlockingType::kNone)}});
    add("state", FullState(version));
    VehicleMemory memory;
    add("state", [&] {
      State state = MakeState(memory, SampleProfile(version), SampleReadings());
      state.header = SampleHeader(version);
      return state;
    }());
    add("connection", Connection{SampleHeader(version), ConnectionState::kConnectionBroken});
    add("factsheet", FullFactsheet(version));
    add("factsheet", SampleFactsheet(version));
    Visualization visualization;
    visualization.header = SampleHeader(version);
    visualization.position = FullState(version).position;
    visualization.velocity = Velocity{1.0, {}, {}};
    add("visualization", visualization);
  }
  payloads.push_back({"zoneSet", Version::k3_0, Encode(FullZoneSet(), Version::k3_0)});
  const Responses responses = {SampleHeader(Version::k3_0), {{"r1", GrantType::kGranted, "1970-01-01T00:00:05.000Z"}}};
  payloads.push_back({"responses", Version::k3_0, Encode(responses, Version::k3_0)});
  return payloads;
}

}  // namespace troupe::fleet
