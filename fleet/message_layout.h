// The members of each message as JSON has them, listed once: readers, writers and both generations of the standard use
// this list. A name or a form that 3.0 has changed stands beside the older one.
//
// An archive is a MessageReader or a MessageWriter. Need: the message has to have the member. May: it may be missing.
// NeedList: a list that has to be there, but that senders leave out when it is empty. has_older, has_newer: whether the
// archive has members that exist until 2.1, and since 3.0; one that keeps values has both.
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include "fleet/factsheet_message.h"
#include "fleet/order_message.h"
#include "fleet/state_message.h"
#include "fleet/zone_message.h"

namespace troupe::fleet {

// The name of a member before 3.0 and since.
struct MemberName {
  constexpr MemberName(const char* both) : older(both), newer(both) {}  // NOLINT(google-explicit-constructor)
  constexpr MemberName(const char* its_older, const char* its_newer) : older(its_older), newer(its_newer) {}

  std::string_view older;
  std::string_view newer;
};

// The numbers that a member may have.
struct NumberRange {
  double min = -1.7976931348623157e308;
  double max = 1.7976931348623157e308;
  bool is_angle = false;  // others are brought into the range by whole turns
};
inline constexpr double kHalfTurn = 3.14159265359;  // as the schemas round it
inline constexpr NumberRange kAngle = {-kHalfTurn, kHalfTurn, true};
inline constexpr NumberRange kAngleDeviation = {-3.141592654, 3.141592654};
inline constexpr NumberRange kNotNegative = {0.0};
inline constexpr NumberRange kUnit = {0.0, 1.0};
inline constexpr NumberRange kPercent = {0.0, 100.0};

template <typename Row, typename Type>
concept RowOf = std::same_as<std::remove_const_t<Row>, Type>;

// ListMembers(archive, row): the members of each type. Of messages and of the types within them.

template <typename Archive, RowOf<Header> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("headerId", row.header_id);
  a.NeedTime("timestamp", row.timestamp);
  a.NeedVersion("version", row.version);
  a.Need("manufacturer", row.manufacturer);
  a.Need("serialNumber", row.serial_number);
}

template <typename Archive, RowOf<ActionParameter> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("key", row.key);
  a.Need("value", row.value);
}

template <typename Archive, RowOf<Action> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("actionType", row.type);
  a.Need("actionId", row.id);
  a.May({"actionDescription", "actionDescriptor"}, row.descriptor);
  a.Need("blockingType", row.blocking_type);
  a.May("actionParameters", row.parameters);
  if (a.has_newer()) a.May("retriable", row.retriable);
}

template <typename Archive, RowOf<NodePosition> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
  a.May("theta", row.theta, kAngle);
  a.May("allowedDeviationXY", row.allowed_deviation_xy);
  a.May("allowedDeviationTheta", row.allowed_deviation_theta, kAngleDeviation);
  a.Need("mapId", row.map_id);
  if (a.has_older()) a.May("mapDescription", row.map_descriptor);
}

template <typename Archive, RowOf<Node> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("nodeId", row.id);
  a.Need("sequenceId", row.sequence_id);
  a.May({"nodeDescription", "nodeDescriptor"}, row.descriptor);
  a.Need("released", row.released);
  a.May("nodePosition", row.position);
  a.NeedList("actions", row.actions);
}

template <typename Archive, RowOf<ControlPoint> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
  a.May("weight", row.weight, kNotNegative);
}

template <typename Archive, RowOf<Trajectory> Row>
void ListMembers(Archive& a, Row& row) {
  a.MaySince3("degree", row.degree, NumberRange{1.0});
  a.MaySince3("knotVector", row.knot_vector, kUnit);
  a.Need("controlPoints", row.control_points);
}

template <typename Archive, RowOf<Corridor> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("leftWidth", row.left_width, kNotNegative);
  a.Need("rightWidth", row.right_width, kNotNegative);
  a.May({"corridorRefPoint", "corridorReferencePoint"}, row.reference_point);
  if (a.has_newer()) {
    a.May("releaseRequired", row.release_required);
    a.May("releaseLossBehavior", row.release_loss_behavior);
  }
}

template <typename Archive, RowOf<Edge> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("edgeId", row.id);
  a.Need("sequenceId", row.sequence_id);
  a.May({"edgeDescription", "edgeDescriptor"}, row.descriptor);
  a.Need("released", row.released);
  if (a.has_older()) {
    a.Need("startNodeId", row.start_node_id);
    a.Need("endNodeId", row.end_node_id);
  }
  a.May({"maxSpeed", "maximumSpeed"}, row.maximum_speed, kNotNegative);
  a.May({"maxHeight", "maximumMobileRobotHeight"}, row.maximum_robot_height);
  a.May({"minHeight", "minimumLoadHandlingDeviceHeight"}, row.minimum_device_height);
  a.May("orientation", row.orientation, kAngle);
  a.May("orientationType", row.orientation_type);
  a.May("direction", row.direction);
  if (a.has_newer()) {
    a.May("reachOrientationBeforeEntering", row.reach_orientation_before_entering);
  }
  if (a.has_older()) {
    a.May("rotationAllowed", row.rotation_allowed);
  }
  a.May("maxRotationSpeed", row.maximum_rotation_speed, kNotNegative);
  a.May("length", row.length, kNotNegative);
  a.May("trajectory", row.trajectory);
  a.May("corridor", row.corridor);
  a.NeedList("actions", row.actions);
}

template <typename Archive, RowOf<Order> Row>
void ListMembers(Archive& a, Row& row) {
  a.Inline(row.header);
  a.Need("orderId", row.order_id);
  a.Need("orderUpdateId", row.order_update_id);
  if (a.has_newer()) {
    a.May("orderDescription", row.descriptor);
  }
  if (a.has_older()) {
    a.May("zoneSetId", row.zone_set_id);
  }
  a.Need("nodes", row.nodes);
  a.Need("edges", row.edges);
}

template <typename Archive, RowOf<InstantActions> Row>
void ListMembers(Archive& a, Row& row) {
  a.Inline(row.header);
  a.Need("actions", row.actions);
}

template <typename Archive, RowOf<MapState> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("mapId", row.map_id);
  a.Need("mapVersion", row.version);
  a.May({"mapDescription", "mapDescriptor"}, row.descriptor);
  a.Need("mapStatus", row.status);
}

template <typename Archive, RowOf<ZoneSetState> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("zoneSetId", row.zone_set_id);
  a.Need("mapId", row.map_id);
  a.Need("zoneSetStatus", row.status);
}

template <typename Archive, RowOf<NodeState> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("nodeId", row.node_id);
  a.Need("sequenceId", row.sequence_id);
  a.May({"nodeDescription", "nodeDescriptor"}, row.descriptor);
  a.Need("released", row.released);
  a.May("nodePosition", row.position);
}

template <typename Archive, RowOf<EdgeState> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("edgeId", row.edge_id);
  a.Need("sequenceId", row.sequence_id);
  a.May({"edgeDescription", "edgeDescriptor"}, row.descriptor);
  a.Need("released", row.released);
  a.May("trajectory", row.trajectory);
}

template <typename Archive, RowOf<RobotPosition> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
  a.Need("theta", row.theta, kAngle);
  a.Need("mapId", row.map_id);
  if (a.has_older()) a.May("mapDescription", row.map_descriptor);
  a.Need({"positionInitialized", "localized"}, row.localized);
  a.May("localizationScore", row.localization_score, kUnit);
  a.May("deviationRange", row.deviation_range, kNotNegative);
}

template <typename Archive, RowOf<Velocity> Row>
void ListMembers(Archive& a, Row& row) {
  a.May("vx", row.vx);
  a.May("vy", row.vy);
  a.May("omega", row.omega);
}

template <typename Archive, RowOf<BoundingBoxReference> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
  a.Need("z", row.z);
  a.May("theta", row.theta);
}

template <typename Archive, RowOf<LoadDimensions> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("length", row.length, kNotNegative);
  a.Need("width", row.width, kNotNegative);
  a.May("height", row.height, kNotNegative);
}

template <typename Archive, RowOf<Load> Row>
void ListMembers(Archive& a, Row& row) {
  a.May("loadId", row.id);
  a.May("loadType", row.type);
  a.May("loadPosition", row.position);
  a.May("boundingBoxReference", row.bounding_box_reference);
  a.May("loadDimensions", row.dimensions);
  a.May("weight", row.weight, kNotNegative);
}

template <typename Archive, RowOf<ActionState> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("actionId", row.action_id);
  a.May("actionType", row.action_type);
  a.May({"actionDescription", "actionDescriptor"}, row.descriptor);
  a.Need("actionStatus", row.status);
  a.May({"resultDescription", "actionResult"}, row.result);
}

template <typename Archive, RowOf<PowerSupply> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need({"batteryCharge", "stateOfCharge"}, row.state_of_charge, kPercent);
  a.May("batteryVoltage", row.battery_voltage);
  if (a.has_newer()) a.May("batteryCurrent", row.battery_current);
  a.May("batteryHealth", row.battery_health, kPercent);
  a.Need("charging", row.charging);
  a.May({"reach", "range"}, row.range, kNotNegative);
}

template <typename Archive, RowOf<Reference> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("referenceKey", row.key);
  a.Need("referenceValue", row.value);
}

template <typename Archive, RowOf<Translation> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("translationKey", row.key);
  a.Need("translationValue", row.value);
}

template <typename Archive, RowOf<VehicleError> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("errorType", row.type);
  a.May("errorReferences", row.references);
  a.May("errorDescription", row.description);
  if (a.has_newer()) a.May("errorDescriptionTranslations", row.description_translations);
  a.May("errorHint", row.hint);
  if (a.has_newer()) a.May("errorHintTranslations", row.hint_translations);
  a.Need("errorLevel", row.level);
}

template <typename Archive, RowOf<Information> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("infoType", row.type);
  a.May("infoReferences", row.references);
  a.May({"infoDescription", "infoDescriptor"}, row.descriptor);
  a.Need("infoLevel", row.level);
}

template <typename Archive, RowOf<SafetyState> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need({"eStop", "activeEmergencyStop"}, row.emergency_stop);
  a.Need("fieldViolation", row.field_violation);
}

template <typename Archive, RowOf<PlannedPath> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("trajectory", row.trajectory);
  a.May("traversedNodes", row.traversed_nodes);
}

template <typename Archive, RowOf<Waypoint> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
  a.May("theta", row.theta, kAngle);
  a.Need("eta", row.eta);
}

template <typename Archive, RowOf<IntermediatePath> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("polyline", row.polyline);
}

template <typename Archive, RowOf<ZoneRequest> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("requestId", row.id);
  a.Need("requestType", row.type);
  a.Need("zoneId", row.zone_id);
  a.Need("zoneSetId", row.zone_set_id);
  a.Need("requestStatus", row.status);
  a.May("trajectory", row.trajectory);
}

template <typename Archive, RowOf<EdgeRequest> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("requestId", row.id);
  a.Need("requestType", row.type);
  a.Need("edgeId", row.edge_id);
  a.Need("sequenceId", row.sequence_id);
  a.Need("requestStatus", row.status);
}

template <typename Archive, RowOf<State> Row>
void ListMembers(Archive& a, Row& row) {
  a.Inline(row.header);
  a.May("maps", row.maps);
  if (a.has_newer()) a.May("zoneSets", row.zone_sets);
  a.Need("orderId", row.order_id);
  a.Need("orderUpdateId", row.order_update_id);
  if (a.has_older()) a.May("zoneSetId", row.zone_set_id);
  a.Need("lastNodeId", row.last_node_id);
  a.Need("lastNodeSequenceId", row.last_node_sequence_id);
  a.Need("nodeStates", row.node_states);
  a.Need("edgeStates", row.edge_states);
  if (a.has_newer()) {
    a.May("plannedPath", row.planned_path);
    a.May("intermediatePath", row.intermediate_path);
  }
  a.May({"agvPosition", "mobileRobotPosition"}, row.position);
  a.May("velocity", row.velocity);
  a.May("loads", row.loads);
  a.Need("driving", row.driving);
  a.May("paused", row.paused);
  a.May("newBaseRequest", row.new_base_request);
  if (a.has_newer()) {
    a.May("zoneRequests", row.zone_requests);
    a.May("edgeRequests", row.edge_requests);
  }
  a.May("distanceSinceLastNode", row.distance_since_last_node);
  a.Need("actionStates", row.action_states);
  if (a.has_newer()) {
    a.Need("instantActionStates", row.instant_action_states);
    a.May("zoneActionStates", row.zone_action_states);
  }
  a.Need({"batteryState", "powerSupply"}, row.power_supply);
  a.Need("operatingMode", row.operating_mode);
  a.Need("errors", row.errors);
  a.May("information", row.information);
  a.Need("safetyState", row.safety_state);
}

template <typename Archive, RowOf<Visualization> Row>
void ListMembers(Archive& a, Row& row) {
  a.InlineOptional(row.header);
  if (a.has_newer()) {
    a.Need("referenceStateHeaderId", row.reference_state_header_id);
    a.May("plannedPath", row.planned_path);
    a.May("intermediatePath", row.intermediate_path);
  }
  a.May({"agvPosition", "mobileRobotPosition"}, row.position);
  a.May("velocity", row.velocity);
}

template <typename Archive, RowOf<Connection> Row>
void ListMembers(Archive& a, Row& row) {
  a.Inline(row.header);
  a.Need("connectionState", row.state);
}

template <typename Archive, RowOf<TypeSpecification> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("seriesName", row.series_name);
  a.May("seriesDescription", row.series_description);
  a.Need({"agvKinematic", "mobileRobotKinematics"}, row.kinematics);
  a.Need({"agvClass", "mobileRobotClass"}, row.robot_class);
  a.Need({"maxLoadMass", "maximumLoadMass"}, row.maximum_load_mass, kNotNegative);
  a.Need("localizationTypes", row.localization_types);
  a.Need("navigationTypes", row.navigation_types);
  if (a.has_newer()) a.May("supportedZones", row.supported_zones);
}

template <typename Archive, RowOf<PhysicalParameters> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need({"speedMin", "minimumSpeed"}, row.minimum_speed);
  a.Need({"speedMax", "maximumSpeed"}, row.maximum_speed);
  a.May({"angularSpeedMin", "minimumAngularSpeed"}, row.minimum_angular_speed);
  a.May({"angularSpeedMax", "maximumAngularSpeed"}, row.maximum_angular_speed);
  a.Need({"accelerationMax", "maximumAcceleration"}, row.maximum_acceleration);
  a.Need({"decelerationMax", "maximumDeceleration"}, row.maximum_deceleration);
  a.NeedSince3({"heightMin", "minimumHeight"}, row.minimum_height);
  a.Need({"heightMax", "maximumHeight"}, row.maximum_height);
  a.Need("width", row.width);
  a.Need("length", row.length);
}

template <typename Archive, RowOf<StringLimits> Row>
void ListMembers(Archive& a, Row& row) {
  a.May({"msgLen", "maximumMessageLength"}, row.message);
  a.May({"topicSerialLen", "maximumTopicSerialLength"}, row.topic_serial);
  a.May({"topicElemLen", "maximumTopicElementLength"}, row.topic_element);
  a.May({"idLen", "maximumIdLength"}, row.id);
  a.May("idNumericalOnly", row.id_numerical_only);
  if (a.has_older()) a.May("enumLen", row.enumeration);
  a.May({"loadIdLen", "maximumLoadIdLength"}, row.load_id);
}

template <typename Archive, RowOf<ArrayLimits> Row>
void ListMembers(Archive& a, Row& row) {
  a.May("order.nodes", row.order_nodes);
  a.May("order.edges", row.order_edges);
  a.May("node.actions", row.node_actions);
  a.May("edge.actions", row.edge_actions);
  a.May("actions.actionsParameters", row.action_parameters);
  a.May("instantActions", row.instant_actions);
  a.May("trajectory.knotVector", row.knot_vector);
  a.May("trajectory.controlPoints", row.control_points);
  if (a.has_newer()) a.May("zoneSet.zones", row.zones);
  a.May("state.nodeStates", row.node_states);
  a.May("state.edgeStates", row.edge_states);
  a.May("state.loads", row.loads);
  a.May("state.actionStates", row.action_states);
  if (a.has_newer()) {
    a.May("state.instantActionStates", row.instant_action_states);
    a.May("state.zoneActionStates", row.zone_action_states);
  }
  a.May("state.errors", row.errors);
  a.May("state.information", row.information);
  a.May("error.errorReferences", row.error_references);
  a.May("information.infoReferences", row.information_references);
}

template <typename Archive, RowOf<TimingLimits> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need({"minOrderInterval", "minimumOrderInterval"}, row.minimum_order_interval, kNotNegative);
  a.Need({"minStateInterval", "minimumStateInterval"}, row.minimum_state_interval, kNotNegative);
  a.May("defaultStateInterval", row.default_state_interval, kNotNegative);
  a.May("visualizationInterval", row.visualization_interval, kNotNegative);
}

template <typename Archive, RowOf<ProtocolLimits> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need({"maxStringLens", "maximumStringLengths"}, row.strings);
  a.Need({"maxArrayLens", "maximumArrayLengths"}, row.arrays);
  a.Need("timing", row.timing);
}

template <typename Archive, RowOf<OptionalParameter> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("parameter", row.parameter);
  a.Need("support", row.support);
  a.May("description", row.description);
}

template <typename Archive, RowOf<ParameterSpecification> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("key", row.key);
  a.Need("valueDataType", row.value_type);
  a.May("description", row.description);
  a.May("isOptional", row.is_optional);
}

template <typename Archive, RowOf<ActionSpecification> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("actionType", row.type);
  a.May("actionDescription", row.description);
  a.Need("actionScopes", row.scopes);
  a.May("actionParameters", row.parameters);
  a.May({"resultDescription", "actionResult"}, row.result);
  a.May("blockingTypes", row.blocking_types);
  if (a.has_newer()) {
    a.Need("pauseAllowed", row.pause_allowed);
    a.Need("cancelAllowed", row.cancel_allowed);
  }
}

template <typename Archive, RowOf<ProtocolFeatures> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("optionalParameters", row.optional_parameters);
  a.Need({"agvActions", "mobileRobotActions"}, row.actions);
}

template <typename Archive, RowOf<WheelPosition> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
  a.May("theta", row.theta);
}

template <typename Archive, RowOf<Wheel> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("type", row.type);
  a.Need("isActiveDriven", row.is_driven);
  a.Need("isActiveSteered", row.is_steered);
  a.Need("position", row.position);
  a.Need("diameter", row.diameter);
  a.Need("width", row.width);
  a.May("centerDisplacement", row.center_displacement);
  a.May("constraints", row.constraints);
}

template <typename Archive, RowOf<OutlineVertex> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
}

template <typename Archive, RowOf<Envelope> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need({"set", "envelope2dId"}, row.id);
  a.Need({"polygonPoints", "vertices"}, row.vertices);
  a.May("description", row.description);
}

template <typename Archive, RowOf<VehicleGeometry> Row>
void ListMembers(Archive& a, Row& row) {
  a.May("wheelDefinitions", row.wheels);
  a.May("envelopes2d", row.envelopes);
}

template <typename Archive, RowOf<LoadSet> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("setName", row.name);
  a.Need("loadType", row.load_type);
  a.May("loadPositions", row.load_positions);
  a.May("boundingBoxReference", row.bounding_box_reference);
  a.May("loadDimensions", row.dimensions);
  a.May({"maxWeight", "maximumWeight"}, row.maximum_weight);
  a.May({"minLoadhandlingHeight", "minimumLoadhandlingHeight"}, row.minimum_height);
  a.May({"maxLoadhandlingHeight", "maximumLoadhandlingHeight"}, row.maximum_height);
  a.May({"minLoadhandlingDepth", "minimumLoadhandlingDepth"}, row.minimum_depth);
  a.May({"maxLoadhandlingDepth", "maximumLoadhandlingDepth"}, row.maximum_depth);
  a.May({"minLoadhandlingTilt", "minimumLoadhandlingTilt"}, row.minimum_tilt);
  a.May({"maxLoadhandlingTilt", "maximumLoadhandlingTilt"}, row.maximum_tilt);
  a.May({"agvSpeedLimit", "maximumSpeed"}, row.maximum_speed);
  a.May({"agvAccelerationLimit", "maximumAcceleration"}, row.maximum_acceleration);
  a.May({"agvDecelerationLimit", "maximumDeceleration"}, row.maximum_deceleration);
  a.May("pickTime", row.pick_time);
  a.May("dropTime", row.drop_time);
  a.May("description", row.description);
}

template <typename Archive, RowOf<LoadSpecification> Row>
void ListMembers(Archive& a, Row& row) {
  a.May("loadPositions", row.load_positions);
  a.May("loadSets", row.load_sets);
}

template <typename Archive, RowOf<ConfiguredVersion> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("key", row.key);
  a.Need("value", row.value);
}

template <typename Archive, RowOf<BatteryCharging> Row>
void ListMembers(Archive& a, Row& row) {
  a.May("criticalLowChargingLevel", row.critical_low_level, kPercent);
  a.May("minimumDesiredChargingLevel", row.minimum_desired_level, kPercent);
  a.May("maximumDesiredChargingLevel", row.maximum_desired_level, kPercent);
  a.May("minimumChargingTime", row.minimum_time, kNotNegative);
}

template <typename Archive, RowOf<VehicleConfiguration> Row>
void ListMembers(Archive& a, Row& row) {
  a.May("versions", row.versions);
  if (a.has_newer()) a.May("batteryCharging", row.battery_charging);
}

template <typename Archive, RowOf<Factsheet> Row>
void ListMembers(Archive& a, Row& row) {
  a.InlineOptional(row.header);
  a.Need("typeSpecification", row.type);
  a.Need("physicalParameters", row.physical);
  a.Need("protocolLimits", row.limits);
  a.Need("protocolFeatures", row.features);
  a.Need({"agvGeometry", "mobileRobotGeometry"}, row.geometry);
  a.Need("loadSpecification", row.load);
  a.May({"vehicleConfig", "mobileRobotConfiguration"}, row.configuration);
}

// Actions of zones have no ids in their set.
template <typename Archive, RowOf<ZoneAction> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("actionType", row.type);
  a.May("actionDescriptor", row.descriptor);
  a.Need("blockingType", row.blocking_type);
  a.May("actionParameters", row.parameters);
  a.May("retriable", row.retriable);
}

template <typename Archive, RowOf<ZoneVertex> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("x", row.x);
  a.Need("y", row.y);
}

// The parameters that a type of zone has to have are not optional.
template <typename Archive, RowOf<Zone> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("zoneId", row.id);
  a.Need("zoneType", row.type);
  a.May("zoneDescriptor", row.descriptor);
  a.Need("vertices", row.vertices);
  const auto of_type = [&](ZoneType type, MemberName name, auto& member, const NumberRange& range = {}) {
    if (row.type == type) {
      a.NeedOptional(name, member, range);
    } else {
      a.May(name, member, range);
    }
  };
  of_type(ZoneType::kRelease, "releaseLossBehavior", row.release_loss_behavior);
  of_type(ZoneType::kSpeedLimit, "maximumSpeed", row.maximum_speed, kNotNegative);
  of_type(ZoneType::kAction, "entryActions", row.entry_actions);
  of_type(ZoneType::kAction, "duringActions", row.during_actions);
  of_type(ZoneType::kAction, "exitActions", row.exit_actions);
  of_type(ZoneType::kPriority, "priorityFactor", row.priority_factor, kUnit);
  of_type(ZoneType::kPenalty, "penaltyFactor", row.penalty_factor, kUnit);
  if (row.type == ZoneType::kDirected || row.type == ZoneType::kBidirected) {
    a.NeedOptional("direction", row.direction);
  } else {
    a.May("direction", row.direction);
  }
  of_type(ZoneType::kDirected, "directedLimitation", row.directed_limitation);
  of_type(ZoneType::kBidirected, "bidirectedLimitation", row.bidirected_limitation);
}

template <typename Archive, RowOf<ZoneSet> Row>
void ListMembers(Archive& a, Row& row) {
  a.Inline(row.header);
  a.Nested("zoneSet", [&row](auto& inner) {
    inner.Need("mapId", row.map_id);
    inner.Need("zoneSetId", row.zone_set_id);
    inner.May("zoneSetDescriptor", row.descriptor);
    inner.Need("zones", row.zones);
  });
}

template <typename Archive, RowOf<RequestResponse> Row>
void ListMembers(Archive& a, Row& row) {
  a.Need("requestId", row.request_id);
  a.Need({"responseType", "grantType"}, row.grant_type);
  a.May("leaseExpiry", row.lease_expiry);
}

template <typename Archive, RowOf<Responses> Row>
void ListMembers(Archive& a, Row& row) {
  a.Inline(row.header);
  a.Need("responses", row.responses);
}

}  // namespace troupe::fleet
