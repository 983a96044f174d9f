// Robots with their sensors, joints and grippers.
#include <algorithm>
#include <utility>

#include "transport/dds/convert/convert_parts.h"
#include "transport/dds/convert/sensor_numbers.h"

namespace troupe::dds {
namespace {

constexpr std::uint8_t kLastDriveType = static_cast<std::uint8_t>(DriveType::kCar);
constexpr std::uint8_t kLastLocalizationType = static_cast<std::uint8_t>(LocalizationType::kOdometry);
constexpr std::uint8_t kLastJointType = static_cast<std::uint8_t>(JointType::kRevolute);

troupe_wire_TwistBounds ToWire(const TwistBounds& bounds) {
  return {bounds.x.min, bounds.x.max, bounds.y.min, bounds.y.max, bounds.heading.min, bounds.heading.max};
}
TwistBounds FromWire(const troupe_wire_TwistBounds& wire) {
  return {{wire.x_min, wire.x_max}, {wire.y_min, wire.y_max}, {wire.heading_min, wire.heading_max}};
}

}  // namespace

troupe_wire_Sensor ToWire(const SensorDescription& sensor, WireArena& arena) {
  troupe_wire_Sensor wire{};
  wire.name = arena.Copy(sensor.name);
  wire.type = arena.Copy(std::string(TypeOf(sensor.parameters)));
  wire.model = static_cast<std::uint32_t>(sensor.model.index());
  wire.period = sensor.period_ticks;
  const std::vector<NamedNumbers> fields = NumbersOf(sensor.parameters);
  troupe_wire_SensorField* out = arena.Fill(wire.fields, fields.size());
  for (const NamedNumbers& field : fields) {
    out->name = arena.Copy(field.name);
    std::copy(field.numbers.begin(), field.numbers.end(), arena.Fill(out->numbers, field.numbers.size()));
    ++out;
  }
  return wire;
}
Status FromWire(const troupe_wire_Sensor& wire, SensorDescription& sensor) {
  sensor.name = Text(wire.name);
  sensor.model = ModelId(wire.model);
  sensor.period_ticks = wire.period;
  std::vector<NamedNumbers> fields;
  for (const troupe_wire_SensorField& field : Elements(wire.fields)) {
    const auto numbers = Elements(field.numbers);
    fields.push_back({Text(field.name), {numbers.begin(), numbers.end()}});
  }
  Result<SensorParameters> parameters = ParametersFrom(Text(wire.type), fields);
  if (!parameters.ok()) return Error{{}, "sensor '" + sensor.name + "': " + parameters.error().message};
  sensor.parameters = std::move(parameters).value();
  return {};
}

troupe_wire_Robot ToWire(const RobotDescription& robot, WireArena& arena) {
  troupe_wire_Robot wire{};
  wire.name = arena.Copy(robot.name);
  wire.root = static_cast<std::uint32_t>(robot.root.index());
  wire.drive.type = static_cast<std::uint8_t>(robot.drive.type);
  wire.drive.wheelbase = robot.drive.wheelbase;
  wire.drive.velocity = ToWire(robot.drive.velocity);
  wire.drive.acceleration = ToWire(robot.drive.acceleration);
  wire.localization = {static_cast<std::uint8_t>(robot.localization.type), PoseToWire(robot.localization.origin),
                       robot.localization.error_x, robot.localization.error_y, robot.localization.error_heading};
  PartsToWire(robot.sensors, wire.sensors, arena);
  wire.controller = {arena.Copy(robot.controller.name), arena.Copy(robot.controller.parameters)};
  wire.ros_domain = robot.ros.domain ? static_cast<std::int32_t>(*robot.ros.domain) : kNoIndex;
  wire.ros_namespace = arena.Copy(robot.ros.name_space);
  return wire;
}
Status FromWire(const troupe_wire_Robot& wire, RobotDescription& robot) {
  robot.name = Text(wire.name);
  robot.root = ModelId(wire.root);
  if (wire.drive.type > kLastDriveType || wire.localization.type > kLastLocalizationType) {
    return Error{{},
                 "robot '" + robot.name + "' with drive type " + std::to_string(wire.drive.type) +
                     " and localization type " + std::to_string(wire.localization.type) + ", expected known types"};
  }
  robot.drive = {static_cast<DriveType>(wire.drive.type), wire.drive.wheelbase, FromWire(wire.drive.velocity),
                 FromWire(wire.drive.acceleration)};
  robot.localization = {static_cast<LocalizationType>(wire.localization.type), PoseFromWire(wire.localization.origin),
                        wire.localization.error_x, wire.localization.error_y, wire.localization.error_heading};
  if (Status failed = PartsFromWire(wire.sensors, robot.sensors); !failed.ok()) return failed;
  robot.controller = {Text(wire.controller.name), Text(wire.controller.parameters)};
  if (wire.ros_domain < kNoIndex) {
    return Error{{}, "robot '" + robot.name + "' with the ROS domain " + std::to_string(wire.ros_domain)};
  }
  if (wire.ros_domain != kNoIndex) robot.ros.domain = static_cast<std::uint32_t>(wire.ros_domain);
  robot.ros.name_space = Text(wire.ros_namespace);
  return {};
}

troupe_wire_Joint ToWire(const JointDescription& joint, WireArena& arena) {
  troupe_wire_Joint wire{};
  wire.name = arena.Copy(joint.name);
  wire.robot = static_cast<std::uint32_t>(joint.robot.index());
  wire.model = static_cast<std::uint32_t>(joint.model.index());
  wire.type = static_cast<std::uint8_t>(joint.type);
  wire.axis_x = joint.axis_xy.x();
  wire.axis_y = joint.axis_xy.y();
  wire.axis_z = joint.axis_z;
  wire.position_min = joint.position.min;
  wire.position_max = joint.position.max;
  wire.start = joint.start;
  wire.max_speed = joint.max_speed;
  return wire;
}
Status FromWire(const troupe_wire_Joint& wire, JointDescription& joint) {
  joint.name = Text(wire.name);
  if (wire.type > kLastJointType) {
    return Error{{}, "joint '" + joint.name + "' with type " + std::to_string(wire.type) + ", expected a known one"};
  }
  joint.robot = RobotId(wire.robot);
  joint.model = ModelId(wire.model);
  joint.type = static_cast<JointType>(wire.type);
  joint.axis_xy = {wire.axis_x, wire.axis_y};
  joint.axis_z = wire.axis_z;
  joint.position = {wire.position_min, wire.position_max};
  joint.start = wire.start;
  joint.max_speed = wire.max_speed;
  return {};
}

troupe_wire_Gripper ToWire(const GripperDescription& gripper, WireArena& arena) {
  troupe_wire_Gripper wire{};
  wire.name = arena.Copy(gripper.name);
  wire.robot = static_cast<std::uint32_t>(gripper.robot.index());
  wire.model = static_cast<std::uint32_t>(gripper.model.index());
  wire.left = static_cast<std::uint32_t>(gripper.left.index());
  wire.right = static_cast<std::uint32_t>(gripper.right.index());
  wire.left_pad = static_cast<std::uint32_t>(gripper.left_pad.index());
  wire.right_pad = static_cast<std::uint32_t>(gripper.right_pad.index());
  wire.lift = gripper.lift ? static_cast<std::int32_t>(gripper.lift->index()) : kNoIndex;
  troupe_wire_BreakBeam* beams = arena.Fill(wire.beams, gripper.beams.size());
  for (const BreakBeam& beam : gripper.beams) {
    *beams++ = {beam.from.x(), beam.from.y(), beam.to.x(), beam.to.y(), beam.z};
  }
  wire.autosnatch = gripper.autosnatch;
  return wire;
}
Status FromWire(const troupe_wire_Gripper& wire, GripperDescription& gripper) {
  gripper.name = Text(wire.name);
  gripper.robot = RobotId(wire.robot);
  gripper.model = ModelId(wire.model);
  gripper.left = JointId(wire.left);
  gripper.right = JointId(wire.right);
  gripper.left_pad = ModelId(wire.left_pad);
  gripper.right_pad = ModelId(wire.right_pad);
  if (wire.lift < kNoIndex) return Error{{}, "gripper '" + gripper.name + "' with lift " + std::to_string(wire.lift)};
  if (wire.lift != kNoIndex) gripper.lift = JointId(static_cast<std::size_t>(wire.lift));
  for (const troupe_wire_BreakBeam& beam : Elements(wire.beams)) {
    gripper.beams.push_back({{beam.from_x, beam.from_y}, {beam.to_x, beam.to_y}, beam.z});
  }
  gripper.autosnatch = wire.autosnatch;
  return {};
}

}  // namespace troupe::dds
