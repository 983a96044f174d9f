// The factsheet of a vehicle of VDA 5050 as plain values: what it is, what it can do, and the limits of its messages.
// Kinds that the standard leaves open (kinematics, classes) are the texts of the version that the sheet is written for.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fleet/state_message.h"

namespace troupe::fleet {

struct TypeSpecification {
  std::string series_name;
  std::optional<std::string> series_description;
  std::string kinematics;  // DIFF, OMNI, THREEWHEEL; 3.0: DIFFERENTIAL, OMNIDIRECTIONAL, THREE_WHEEL
  std::string robot_class;
  double maximum_load_mass = 0.0;  // kg
  std::vector<std::string> localization_types;
  std::vector<std::string> navigation_types;
  std::optional<std::vector<std::string>> supported_zones;  // 3.0

  bool operator==(const TypeSpecification&) const = default;
};

struct PhysicalParameters {
  double minimum_speed = 0.0;  // m/s
  double maximum_speed = 0.0;
  std::optional<double> minimum_angular_speed;  // rad/s
  std::optional<double> maximum_angular_speed;
  double maximum_acceleration = 0.0;  // m/s^2
  double maximum_deceleration = 0.0;
  double minimum_height = 0.0;  // m
  double maximum_height = 0.0;
  double width = 0.0;
  double length = 0.0;

  bool operator==(const PhysicalParameters&) const = default;
};

struct StringLimits {
  std::optional<std::uint32_t> message;
  std::optional<std::uint32_t> topic_serial;
  std::optional<std::uint32_t> topic_element;
  std::optional<std::uint32_t> id;
  std::optional<bool> id_numerical_only;
  std::optional<std::uint32_t> enumeration;  // until 2.1
  std::optional<std::uint32_t> load_id;

  bool operator==(const StringLimits&) const = default;
};

// Missing or 0: no limit.
struct ArrayLimits {
  std::optional<std::uint32_t> order_nodes;
  std::optional<std::uint32_t> order_edges;
  std::optional<std::uint32_t> node_actions;
  std::optional<std::uint32_t> edge_actions;
  std::optional<std::uint32_t> action_parameters;
  std::optional<std::uint32_t> instant_actions;
  std::optional<std::uint32_t> knot_vector;
  std::optional<std::uint32_t> control_points;
  std::optional<std::uint32_t> zones;  // 3.0
  std::optional<std::uint32_t> node_states;
  std::optional<std::uint32_t> edge_states;
  std::optional<std::uint32_t> loads;
  std::optional<std::uint32_t> action_states;
  std::optional<std::uint32_t> instant_action_states;  // 3.0
  std::optional<std::uint32_t> zone_action_states;     // 3.0
  std::optional<std::uint32_t> errors;
  std::optional<std::uint32_t> information;
  std::optional<std::uint32_t> error_references;
  std::optional<std::uint32_t> information_references;

  bool operator==(const ArrayLimits&) const = default;
};

struct TimingLimits {
  double minimum_order_interval = 0.0;  // s
  double minimum_state_interval = 0.0;
  std::optional<double> default_state_interval;
  std::optional<double> visualization_interval;

  bool operator==(const TimingLimits&) const = default;
};

struct ProtocolLimits {
  StringLimits strings;
  ArrayLimits arrays;
  TimingLimits timing;

  bool operator==(const ProtocolLimits&) const = default;
};

enum class Support : std::uint8_t { kSupported, kRequired };
constexpr auto NamesOf(Support) {
  return std::array{"SUPPORTED", "REQUIRED"};
}

struct OptionalParameter {
  std::string parameter;  // "order.edges.trajectory"
  Support support = Support::kSupported;
  std::optional<std::string> description;

  bool operator==(const OptionalParameter&) const = default;
};

enum class ActionScope : std::uint8_t { kInstant, kNode, kEdge, kZone };
constexpr auto NamesOf(ActionScope) {
  return std::array{"INSTANT", "NODE", "EDGE", "ZONE"};
}

struct ParameterSpecification {
  std::string key;
  std::string value_type;  // BOOL, NUMBER, INTEGER, FLOAT (until 2.1), STRING, OBJECT, ARRAY
  std::optional<std::string> description;
  std::optional<bool> is_optional;

  bool operator==(const ParameterSpecification&) const = default;
};

struct ActionSpecification {
  std::string type;
  std::optional<std::string> description;
  std::vector<ActionScope> scopes;
  std::optional<std::vector<ParameterSpecification>> parameters;
  std::optional<std::string> result;
  std::optional<std::vector<BlockingType>> blocking_types;
  bool pause_allowed = false;   // 3.0
  bool cancel_allowed = false;  // 3.0

  bool IsFor(ActionScope scope) const;

  bool operator==(const ActionSpecification&) const = default;
};

struct ProtocolFeatures {
  std::vector<OptionalParameter> optional_parameters;
  std::vector<ActionSpecification> actions;

  bool operator==(const ProtocolFeatures&) const = default;
};

struct WheelPosition {
  double x = 0.0;
  double y = 0.0;
  std::optional<double> theta;

  bool operator==(const WheelPosition&) const = default;
};

struct Wheel {
  std::string type;  // DRIVE, CASTER, FIXED, MECANUM
  bool is_driven = false;
  bool is_steered = false;
  WheelPosition position;
  double diameter = 0.0;  // m
  double width = 0.0;
  std::optional<double> center_displacement;
  std::optional<std::string> constraints;

  bool operator==(const Wheel&) const = default;
};

struct OutlineVertex {
  double x = 0.0;
  double y = 0.0;

  bool operator==(const OutlineVertex&) const = default;
};

struct Envelope {
  std::string id;
  std::vector<OutlineVertex> vertices;
  std::optional<std::string> description;

  bool operator==(const Envelope&) const = default;
};

struct VehicleGeometry {
  std::optional<std::vector<Wheel>> wheels;
  std::optional<std::vector<Envelope>> envelopes;  // in the plane

  bool operator==(const VehicleGeometry&) const = default;
};

struct LoadSet {
  std::string name;
  std::string load_type;
  std::optional<std::vector<std::string>> load_positions;
  std::optional<BoundingBoxReference> bounding_box_reference;
  std::optional<LoadDimensions> dimensions;
  std::optional<double> maximum_weight;  // kg
  std::optional<double> minimum_height;  // m
  std::optional<double> maximum_height;
  std::optional<double> minimum_depth;
  std::optional<double> maximum_depth;
  std::optional<double> minimum_tilt;  // rad
  std::optional<double> maximum_tilt;
  std::optional<double> maximum_speed;  // m/s
  std::optional<double> maximum_acceleration;
  std::optional<double> maximum_deceleration;
  std::optional<double> pick_time;  // s
  std::optional<double> drop_time;
  std::optional<std::string> description;

  bool operator==(const LoadSet&) const = default;
};

struct LoadSpecification {
  std::optional<std::vector<std::string>> load_positions;
  std::optional<std::vector<LoadSet>> load_sets;

  bool operator==(const LoadSpecification&) const = default;
};

struct ConfiguredVersion {
  std::string key;
  std::string value;

  bool operator==(const ConfiguredVersion&) const = default;
};

struct BatteryCharging {
  std::optional<double> critical_low_level;  // from 0 to 100
  std::optional<double> minimum_desired_level;
  std::optional<double> maximum_desired_level;
  std::optional<double> minimum_time;  // s

  bool operator==(const BatteryCharging&) const = default;
};

struct VehicleConfiguration {
  std::optional<std::vector<ConfiguredVersion>> versions;
  std::optional<BatteryCharging> battery_charging;  // 3.0

  bool operator==(const VehicleConfiguration&) const = default;
};

struct Factsheet {
  Header header;
  TypeSpecification type;
  PhysicalParameters physical;
  ProtocolLimits limits;
  ProtocolFeatures features;
  VehicleGeometry geometry;
  LoadSpecification load;
  std::optional<VehicleConfiguration> configuration;

  const ActionSpecification* FindAction(std::string_view type) const;

  bool operator==(const Factsheet&) const = default;
};

}  // namespace troupe::fleet
