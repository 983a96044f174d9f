// The messages of VDA 5050 to a vehicle as plain values: orders and instant actions. One model for the
// versions 2.0, 2.1 and 3.0; codec.h reads and writes the JSON of each.
//
// Names are those of version 3.0 in the project's style. An optional member is one that a message may lack. Frames and
// units are the standard's: metres, seconds, radians; x and y in the frame of the map, counter-clockwise positive.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/enum_names.h"

namespace troupe::fleet {

enum class Version : std::uint8_t { k2_0, k2_1, k3_0 };
constexpr auto NamesOf(Version) {
  return std::array{"2.0", "2.1", "3.0"};
}
constexpr bool IsBefore3(Version version) {
  return version != Version::k3_0;
}
// Of "2.1.0"; nothing if the text has no such form or the version is none of these. Every 2.x above 2.0 is read as 2.1.
std::optional<Version> FindVersion(std::string_view text);
// "2.1.0", as headers have it.
std::string VersionText(Version version);

// The time of a message in milliseconds since 1970-01-01 (UTC), of ISO 8601 with any number of digits behind the
// seconds; nothing if the text has no such form.
std::optional<std::int64_t> ParseTimestamp(std::string_view text);
// With two digits behind the seconds before version 3.0, then three, as the standard says. Times before the year 1970
// and after 9999 become the nearest that can be written.
std::string FormatTimestamp(std::int64_t milliseconds, Version version);

// The first members of every message.
struct Header {
  std::uint32_t header_id = 0;  // counts the messages of a topic and sender
  std::string timestamp;
  std::string version;
  std::string manufacturer;
  std::string serial_number;

  bool operator==(const Header&) const = default;
};

// SINGLE is new in 3.0.
enum class BlockingType : std::uint8_t { kNone, kSoft, kSingle, kHard };
constexpr auto NamesOf(BlockingType) {
  return std::array{"NONE", "SOFT", "SINGLE", "HARD"};
}
constexpr bool StopsDriving(BlockingType type) {
  return type == BlockingType::kSoft || type == BlockingType::kHard;
}
constexpr bool RunsAlone(BlockingType type) {
  return type == BlockingType::kSingle || type == BlockingType::kHard;
}

// The value of a parameter of an action: any JSON value but null.
struct ParameterValue {
  enum class Kind : std::uint8_t { kString, kNumber, kBoolean, kJson };

  Kind kind = Kind::kString;
  std::string text;  // of a string its characters; else the JSON text without blanks, numbers as they were written

  static ParameterValue Of(std::string_view text) { return {Kind::kString, std::string(text)}; }
  static ParameterValue Of(double number);

  // Fleets often send numbers and flags as strings: those count, too.
  std::optional<double> Number() const;
  std::optional<bool> Boolean() const;

  bool operator==(const ParameterValue&) const = default;
};

struct ActionParameter {
  std::string key;
  ParameterValue value;

  bool operator==(const ActionParameter&) const = default;
};

struct Action {
  std::string type;
  std::string id;
  std::optional<std::string> descriptor;
  BlockingType blocking_type = BlockingType::kNone;
  std::optional<std::vector<ActionParameter>> parameters;
  std::optional<bool> retriable;  // 3.0

  const ParameterValue* FindParameter(std::string_view key) const;
  // The characters of a parameter; empty if there is none.
  std::string TextOf(std::string_view key) const;

  bool operator==(const Action&) const = default;
};

// A round one (a = b, theta = 0) is the only kind before 3.0.
struct AllowedDeviation {
  double a = 0.0;  // m
  double b = 0.0;
  double theta = 0.0;

  bool operator==(const AllowedDeviation&) const = default;
};

struct NodePosition {
  double x = 0.0;
  double y = 0.0;
  std::optional<double> theta;
  std::optional<AllowedDeviation> allowed_deviation_xy;
  std::optional<double> allowed_deviation_theta;
  std::string map_id;
  std::optional<std::string> map_descriptor;  // until 2.1

  bool operator==(const NodePosition&) const = default;
};

struct Node {
  std::string id;
  std::uint32_t sequence_id = 0;
  std::optional<std::string> descriptor;
  bool released = false;  // of the base, else of the horizon
  std::optional<NodePosition> position;
  std::vector<Action> actions;

  bool operator==(const Node&) const = default;
};

struct ControlPoint {
  double x = 0.0;
  double y = 0.0;
  std::optional<double> weight;  // 1

  bool operator==(const ControlPoint&) const = default;
};

// A NURBS curve that begins and ends at its first and last control point. Before 3.0 a message has degree and knots.
struct Trajectory {
  std::optional<std::uint32_t> degree;             // 1
  std::optional<std::vector<double>> knot_vector;  // from 0 to 1; missing: uniform and clamped
  std::vector<ControlPoint> control_points;

  bool operator==(const Trajectory&) const = default;
};

enum class CorridorReference : std::uint8_t { kKinematicCenter, kContour };
constexpr auto NamesOf(CorridorReference) {
  return std::array{"KINEMATIC_CENTER", "CONTOUR"};
}
enum class CorridorLoss : std::uint8_t { kStop, kReturn };
constexpr auto NamesOf(CorridorLoss) {
  return std::array{"STOP", "RETURN"};
}

struct Corridor {
  double left_width = 0.0;  // m
  double right_width = 0.0;
  std::optional<CorridorReference> reference_point;
  std::optional<bool> release_required;               // 3.0
  std::optional<CorridorLoss> release_loss_behavior;  // 3.0

  bool operator==(const Corridor&) const = default;
};

enum class OrientationType : std::uint8_t { kGlobal, kTangential };
constexpr auto NamesOf(OrientationType) {
  return std::array{"GLOBAL", "TANGENTIAL"};
}

struct Edge {
  std::string id;
  std::uint32_t sequence_id = 0;
  std::optional<std::string> descriptor;
  bool released = false;
  std::string start_node_id;            // until 2.1
  std::string end_node_id;              // until 2.1
  std::optional<double> maximum_speed;  // m/s
  std::optional<double> maximum_robot_height;
  std::optional<double> minimum_device_height;
  std::optional<double> orientation;
  std::optional<OrientationType> orientation_type;
  std::optional<std::string> direction;
  std::optional<bool> rotation_allowed;                   // until 2.1
  std::optional<bool> reach_orientation_before_entering;  // 3.0
  std::optional<double> maximum_rotation_speed;           // rad/s
  std::optional<double> length;
  std::optional<Trajectory> trajectory;
  std::optional<Corridor> corridor;
  std::vector<Action> actions;

  bool operator==(const Edge&) const = default;
};

struct Order {
  Header header;
  std::string order_id;
  std::uint32_t order_update_id = 0;
  std::optional<std::string> descriptor;   // 3.0
  std::optional<std::string> zone_set_id;  // until 2.1, without a meaning
  std::vector<Node> nodes;
  std::vector<Edge> edges;  // edge i joins the nodes i and i + 1

  bool operator==(const Order&) const = default;
};

// Whether two messages say the same, whenever they were sent.
bool HaveSameContent(const Order& a, const Order& b);

struct InstantActions {
  Header header;
  std::vector<Action> actions;

  bool operator==(const InstantActions&) const = default;
};

}  // namespace troupe::fleet
