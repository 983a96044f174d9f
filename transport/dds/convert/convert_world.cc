#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "transport/dds/convert/convert.h"

namespace troupe::dds {
namespace {

constexpr std::int32_t kNoIndex = -1;
constexpr std::uint8_t kLastDriveType = static_cast<std::uint8_t>(DriveType::kCar);
constexpr std::uint8_t kLastLocalizationType = static_cast<std::uint8_t>(LocalizationType::kOdometry);
constexpr std::uint8_t kLastJointType = static_cast<std::uint8_t>(JointType::kRevolute);
constexpr std::size_t kNumbersOfPoint = 2;
constexpr std::size_t kNumbersOfRectangle = 4;

troupe_wire_TwistBounds ToWire(const TwistBounds& bounds) {
  return {bounds.x.min, bounds.x.max, bounds.y.min, bounds.y.max, bounds.heading.min, bounds.heading.max};
}
TwistBounds FromWire(const troupe_wire_TwistBounds& wire) {
  return {{wire.x_min, wire.x_max}, {wire.y_min, wire.y_max}, {wire.heading_min, wire.heading_max}};
}

troupe_wire_Block ToWire(const Block& block, WireArena& arena) {
  troupe_wire_Block wire{};
  double* out = arena.Fill(wire.outline, block.outline.size() * kNumbersOfPoint);
  for (const Vec2& point : block.outline) {
    *out++ = point.x();
    *out++ = point.y();
  }
  wire.z_min = block.z.min;
  wire.z_max = block.z.max;
  return wire;
}
Status FromWire(const troupe_wire_Block& wire, Block& block) {
  const auto numbers = Elements(wire.outline);
  if (numbers.size() % kNumbersOfPoint != 0 || numbers.size() < 3 * kNumbersOfPoint) {
    return Error{{},
                 "outline of " + std::to_string(numbers.size()) + " numbers, expected x and y of at least 3 points"};
  }
  for (std::size_t i = 0; i < numbers.size(); i += kNumbersOfPoint)
    block.outline.emplace_back(numbers[i], numbers[i + 1]);
  block.z = {wire.z_min, wire.z_max};
  return {};
}

troupe_wire_PixelLines ToWire(const PixelLines& lines) {
  return {lines.center, lines.factor, lines.second_center, lines.second_factor, lines.shift};
}
PixelLines FromWire(const troupe_wire_PixelLines& wire) {
  return {wire.center, wire.factor, wire.second_center, wire.second_factor, wire.shift};
}

troupe_wire_PixelArea ToWire(const PixelArea& area, WireArena& arena) {
  troupe_wire_PixelArea wire{};
  const Bitmap& bitmap = area.cover().bitmap();
  wire.width = static_cast<std::uint32_t>(bitmap.width());
  wire.height = static_cast<std::uint32_t>(bitmap.height());
  const std::size_t words = Bitmap::WordsOf(bitmap.width(), bitmap.height());
  bitmap.Pack({arena.Fill(wire.bits, words), words});
  wire.x = ToWire(area.x());
  wire.y = ToWire(area.y());
  wire.lines_in_model = PoseToWire(area.X_MA());
  return wire;
}
Result<PixelArea> FromWire(const troupe_wire_PixelArea& wire) {
  constexpr std::uint32_t kMaxSide = std::numeric_limits<std::int32_t>::max();
  const auto bits = Elements(wire.bits);
  // Before anything is allocated by these numbers.
  if (wire.width < 1 || wire.height < 1 || wire.width > kMaxSide || wire.height > kMaxSide ||
      bits.size() != (std::uint64_t{wire.width} * wire.height + 63) / 64) {
    return Error{{},
                 "an area of " + std::to_string(wire.width) + " x " + std::to_string(wire.height) + " pixels with " +
                     std::to_string(bits.size()) + " words of 64 bits, expected one bit for each pixel"};
  }
  Bitmap bitmap = Bitmap::Unpacked(static_cast<int>(wire.width), static_cast<int>(wire.height), bits);
  return PixelArea(std::make_shared<const DenseCover>(std::move(bitmap)), FromWire(wire.x), FromWire(wire.y),
                   PoseFromWire(wire.lines_in_model));
}

troupe_wire_Shape ToWire(const Shape& shape, WireArena& arena) {
  troupe_wire_Shape wire{};
  troupe_wire_Block* blocks = arena.Fill(wire.blocks, shape.blocks.size());
  for (const Block& block : shape.blocks) *blocks++ = ToWire(block, arena);
  double* out = arena.Fill(wire.rectangles, shape.rectangles.size() * kNumbersOfRectangle);
  for (const Rectangle& rectangle : shape.rectangles) {
    *out++ = rectangle.min_x;
    *out++ = rectangle.min_y;
    *out++ = rectangle.max_x;
    *out++ = rectangle.max_y;
  }
  wire.rectangles_z_min = shape.rectangles_z.min;
  wire.rectangles_z_max = shape.rectangles_z.max;
  if (shape.area) *arena.Fill(wire.areas, 1) = ToWire(*shape.area, arena);
  return wire;
}
Status FromWire(const troupe_wire_Shape& wire, Shape& shape) {
  shape.blocks.resize(wire.blocks._length);
  for (std::size_t i = 0; i < shape.blocks.size(); ++i) {
    if (Status failed = FromWire(wire.blocks._buffer[i], shape.blocks[i]); !failed.ok()) return failed;
  }
  const auto numbers = Elements(wire.rectangles);
  if (numbers.size() % kNumbersOfRectangle != 0) {
    return Error{{}, "rectangles of " + std::to_string(numbers.size()) + " numbers, expected 4 for each"};
  }
  shape.rectangles.reserve(numbers.size() / kNumbersOfRectangle);
  for (std::size_t i = 0; i < numbers.size(); i += kNumbersOfRectangle) {
    shape.rectangles.push_back({numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]});
  }
  shape.rectangles_z = {wire.rectangles_z_min, wire.rectangles_z_max};
  const auto areas = Elements(wire.areas);
  if (areas.size() > 1) return Error{{}, std::to_string(areas.size()) + " areas of a shape, expected at most 1"};
  if (areas.empty()) return {};
  Result<PixelArea> area = FromWire(areas.front());
  if (!area.ok()) return area.error();
  shape.area = std::move(area).value();
  return {};
}

troupe_wire_Model ToWire(const ModelDescription& model, WireArena& arena) {
  troupe_wire_Model wire{};
  wire.name = arena.Copy(model.name);
  wire.type = arena.Copy(model.type);
  wire.parent = model.parent ? static_cast<std::int32_t>(model.parent->index()) : kNoIndex;
  wire.pose_in_parent = PoseToWire(model.X_PM);
  wire.shape = static_cast<std::uint32_t>(model.shape.index());
  wire.size_x = model.size_x;
  wire.size_y = model.size_y;
  wire.size_z = model.size_z;
  wire.color = {model.color.r, model.color.g, model.color.b, model.color.a};
  wire.obstacle_return = model.obstacle_return;
  wire.ranger_return = model.ranger_return;
  wire.gripper_return = model.gripper_return;
  wire.fiducial_return = model.fiducial_return;
  wire.fiducial_key = model.fiducial_key;
  wire.show_nose = model.show_nose;
  wire.blink_period = model.blinking.period_ns;
  wire.blink_on = model.blinking.on_ns;
  wire.switched_on = model.blinking.is_switched_on;
  wire.has_store = model.power.has_store;
  wire.endless = model.power.endless;
  wire.joules = model.power.joules;
  wire.capacity = model.power.capacity;
  wire.watts = model.power.watts;
  wire.mass = model.power.mass;
  wire.give_watts = model.power.give_watts;
  wire.take_watts = model.power.take_watts;
  wire.map_columns = model.map.columns;
  wire.map_rows = model.map.rows;
  wire.map_resolution = model.map.resolution;
  wire.removed = model.removed;
  return wire;
}
Status FromWire(const troupe_wire_Model& wire, ModelDescription& model) {
  model.name = Text(wire.name);
  model.type = Text(wire.type);
  if (wire.parent < kNoIndex) return Error{{}, "model '" + model.name + "' with parent " + std::to_string(wire.parent)};
  if (wire.parent != kNoIndex) model.parent = ModelId(static_cast<std::size_t>(wire.parent));
  model.X_PM = PoseFromWire(wire.pose_in_parent);
  model.shape = ShapeId(wire.shape);
  model.size_x = wire.size_x;
  model.size_y = wire.size_y;
  model.size_z = wire.size_z;
  model.color = {wire.color.r, wire.color.g, wire.color.b, wire.color.a};
  model.obstacle_return = wire.obstacle_return;
  model.ranger_return = wire.ranger_return;
  model.gripper_return = wire.gripper_return;
  model.fiducial_return = wire.fiducial_return;
  model.fiducial_key = wire.fiducial_key;
  model.show_nose = wire.show_nose;
  model.blinking = {wire.blink_period, wire.blink_on, wire.switched_on};
  model.power = {wire.has_store, wire.endless, wire.joules,     wire.capacity,
                 wire.watts,     wire.mass,    wire.give_watts, wire.take_watts};
  model.map = {wire.map_columns, wire.map_rows, wire.map_resolution};
  model.removed = wire.removed;
  return {};
}

troupe_wire_Sensor ToWire(const SensorDescription& sensor, WireArena& arena) {
  troupe_wire_Sensor wire{};
  wire.name = arena.Copy(sensor.name);
  wire.type = arena.Copy(std::string(TypeOf(sensor.parameters)));
  wire.model = static_cast<std::uint32_t>(sensor.model.index());
  wire.period = sensor.period_ticks;
  const std::vector<SensorField> fields = FieldsOf(sensor.parameters);
  troupe_wire_SensorField* out = arena.Fill(wire.fields, fields.size());
  for (const SensorField& field : fields) {
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
  std::vector<SensorField> fields;
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
  troupe_wire_Sensor* sensors = arena.Fill(wire.sensors, robot.sensors.size());
  for (const SensorDescription& sensor : robot.sensors) *sensors++ = ToWire(sensor, arena);
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
  for (const troupe_wire_Sensor& sensor : Elements(wire.sensors)) {
    if (Status failed = FromWire(sensor, robot.sensors.emplace_back()); !failed.ok()) return failed;
  }
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

troupe_wire_Door ToWire(const DoorDescription& door, WireArena& arena) {
  troupe_wire_Door wire{};
  wire.model = static_cast<std::uint32_t>(door.model.index());
  troupe_wire_DoorLeaf* leaves = arena.Fill(wire.leaves, door.leaves.size());
  for (const DoorLeaf& leaf : door.leaves) {
    *leaves++ = {static_cast<std::uint32_t>(leaf.object.index()), PoseToWire(leaf.X_WH), leaf.turn, leaf.shift};
  }
  wire.seconds = door.seconds;
  wire.reach = door.reach;
  wire.opening = door.opening;
  wire.operated = door.is_operated;
  return wire;
}
DoorDescription FromWire(const troupe_wire_Door& wire) {
  DoorDescription door{.model = ModelId(wire.model), .leaves = {}};
  for (const troupe_wire_DoorLeaf& leaf : Elements(wire.leaves)) {
    door.leaves.push_back({ObjectId(leaf.object), PoseFromWire(leaf.closed), leaf.turn, leaf.shift});
  }
  door.seconds = wire.seconds;
  door.reach = wire.reach;
  door.opening = wire.opening;
  door.is_operated = wire.operated;
  return door;
}

// `Sequence`: one of idlc of 32 bits.
template <typename Sequence>
void NumbersToWire(const std::vector<std::size_t>& numbers, Sequence& wire, WireArena& arena) {
  std::uint32_t* out = arena.Fill(wire, numbers.size());
  for (const std::size_t number : numbers) *out++ = static_cast<std::uint32_t>(number);
}
template <typename Sequence>
std::vector<std::size_t> NumbersFromWire(const Sequence& wire) {
  const auto numbers = Elements(wire);
  return {numbers.begin(), numbers.end()};
}

troupe_wire_Lift ToWire(const LiftDescription& lift, WireArena& arena) {
  troupe_wire_Lift wire{};
  wire.model = static_cast<std::uint32_t>(lift.model.index());
  wire.cabin = static_cast<std::uint32_t>(lift.cabin.index());
  NumbersToWire(lift.cabin_doors, wire.cabin_doors, arena);
  troupe_wire_LiftFloor* floors = arena.Fill(wire.floors, lift.floors.size());
  for (const LiftFloor& floor : lift.floors) {
    floors->name = arena.Copy(floor.name);
    floors->z = floor.z;
    NumbersToWire(floor.doors, floors->doors, arena);
    ++floors;
  }
  wire.floor = lift.floor;
  wire.speed = lift.speed;
  return wire;
}
LiftDescription FromWire(const troupe_wire_Lift& wire) {
  LiftDescription lift{.model = ModelId(wire.model),
                       .cabin = ObjectId(wire.cabin),
                       .cabin_doors = NumbersFromWire(wire.cabin_doors),
                       .floors = {},
                       .floor = wire.floor,
                       .speed = wire.speed};
  for (const troupe_wire_LiftFloor& floor : Elements(wire.floors)) {
    lift.floors.push_back({Text(floor.name), floor.z, NumbersFromWire(floor.doors)});
  }
  return lift;
}

troupe_wire_GoalSet ToWire(const GoalSet& set, WireArena& arena) {
  troupe_wire_GoalSet wire{};
  wire.name = arena.Copy(set.name);
  double* x = arena.Fill(wire.x, set.points.size());
  double* y = arena.Fill(wire.y, set.points.size());
  for (const Vec2& point : set.points) {
    *x++ = point.x();
    *y++ = point.y();
  }
  wire.reach = set.reach;
  wire.wait_min = set.wait.min;
  wire.wait_max = set.wait.max;
  std::uint32_t* next = arena.Fill(wire.next, set.next.size());
  double* weight = arena.Fill(wire.weight, set.next.size());
  for (const NextGoals& choice : set.next) {
    *next++ = choice.goals;
    *weight++ = choice.weight;
  }
  return wire;
}
Status FromWire(const troupe_wire_GoalSet& wire, GoalSet& set) {
  set.name = Text(wire.name);
  const auto x = Elements(wire.x);
  const auto y = Elements(wire.y);
  const auto next = Elements(wire.next);
  const auto weight = Elements(wire.weight);
  if (x.size() != y.size() || next.size() != weight.size()) {
    return Error{{}, "goal set '" + set.name + "' with columns of different lengths"};
  }
  for (std::size_t i = 0; i < x.size(); ++i) set.points.emplace_back(x[i], y[i]);
  set.reach = wire.reach;
  set.wait = {wire.wait_min, wire.wait_max};
  for (std::size_t i = 0; i < next.size(); ++i) set.next.push_back({next[i], weight[i]});
  return {};
}

troupe_wire_Person ToWire(const PersonDescription& person) {
  troupe_wire_Person wire{};
  wire.root = static_cast<std::uint32_t>(person.root.index());
  wire.radius = person.radius;
  wire.speed = person.speed;
  wire.max_speed = person.max_speed;
  wire.reaction = static_cast<std::uint8_t>(person.reaction);
  wire.goals = person.goals;
  wire.leader = person.leader ? static_cast<std::int32_t>(person.leader->index()) : kNoIndex;
  return wire;
}
Status FromWire(const troupe_wire_Person& wire, PersonDescription& person) {
  person.root = ModelId(wire.root);
  person.radius = wire.radius;
  person.speed = wire.speed;
  person.max_speed = wire.max_speed;
  person.reaction = static_cast<PersonReaction>(wire.reaction);
  person.goals = wire.goals;
  if (wire.leader < kNoIndex) return Error{{}, "person with leader " + std::to_string(wire.leader)};
  if (wire.leader != kNoIndex) person.leader = PersonId(static_cast<std::size_t>(wire.leader));
  return {};
}

}  // namespace

troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena) {
  troupe_wire_World wire{};
  wire.name = arena.Copy(world.name);
  wire.seed = world.seed;
  wire.interval = world.interval_ns;
  troupe_wire_Shape* shapes = arena.Fill(wire.shapes, world.shapes.size());
  for (const Shape& shape : world.shapes) *shapes++ = ToWire(shape, arena);
  troupe_wire_Model* models = arena.Fill(wire.models, world.models.size());
  for (const ModelDescription& model : world.models) *models++ = ToWire(model, arena);
  troupe_wire_Robot* robots = arena.Fill(wire.robots, world.robots.size());
  for (const RobotDescription& robot : world.robots) *robots++ = ToWire(robot, arena);
  troupe_wire_Joint* joints = arena.Fill(wire.joints, world.joints.size());
  for (const JointDescription& joint : world.joints) *joints++ = ToWire(joint, arena);
  troupe_wire_Gripper* grippers = arena.Fill(wire.grippers, world.grippers.size());
  for (const GripperDescription& gripper : world.grippers) *grippers++ = ToWire(gripper, arena);
  std::uint32_t* objects = arena.Fill(wire.objects, world.objects.size());
  for (ModelId object : world.objects) *objects++ = static_cast<std::uint32_t>(object.index());
  wire.gravity = world.gravity;
  troupe_wire_Place* places = arena.Fill(wire.places, world.places.size());
  for (const NamedPlace& place : world.places) {
    places->name = arena.Copy(place.name);
    places->description = arena.Copy(place.description);
    arena.FillStrings(places->tags, place.tags);
    places->pose = PoseToWire(place.X_WN);
    ++places;
  }
  troupe_wire_Door* doors = arena.Fill(wire.doors, world.doors.size());
  for (const DoorDescription& door : world.doors) *doors++ = ToWire(door, arena);
  troupe_wire_Lift* lifts = arena.Fill(wire.lifts, world.lifts.size());
  for (const LiftDescription& lift : world.lifts) *lifts++ = ToWire(lift, arena);
  troupe_wire_GoalSet* goal_sets = arena.Fill(wire.goal_sets, world.goal_sets.size());
  for (const GoalSet& set : world.goal_sets) *goal_sets++ = ToWire(set, arena);
  troupe_wire_Person* people = arena.Fill(wire.people, world.people.size());
  for (const PersonDescription& person : world.people) *people++ = ToWire(person);
  return wire;
}

Result<WorldDescription> FromWire(const troupe_wire_World& wire) {
  WorldDescription world;
  world.name = Text(wire.name);
  world.seed = wire.seed;
  world.interval_ns = wire.interval;
  for (const troupe_wire_Shape& shape : Elements(wire.shapes)) {
    if (Status failed = FromWire(shape, world.shapes.emplace_back()); !failed.ok()) return failed.error();
  }
  for (const troupe_wire_Model& model : Elements(wire.models)) {
    if (Status failed = FromWire(model, world.models.emplace_back()); !failed.ok()) return failed.error();
  }
  for (const troupe_wire_Robot& robot : Elements(wire.robots)) {
    if (Status failed = FromWire(robot, world.robots.emplace_back()); !failed.ok()) return failed.error();
  }
  for (const troupe_wire_Joint& joint : Elements(wire.joints)) {
    if (Status failed = FromWire(joint, world.joints.emplace_back()); !failed.ok()) return failed.error();
  }
  for (const troupe_wire_Gripper& gripper : Elements(wire.grippers)) {
    if (Status failed = FromWire(gripper, world.grippers.emplace_back()); !failed.ok()) return failed.error();
  }
  for (std::uint32_t object : Elements(wire.objects)) world.objects.emplace_back(object);
  world.gravity = wire.gravity;
  for (const troupe_wire_Place& place : Elements(wire.places)) {
    world.places.push_back({Text(place.name), Text(place.description), Strings(place.tags), PoseFromWire(place.pose)});
  }
  for (const troupe_wire_Door& door : Elements(wire.doors)) world.doors.push_back(FromWire(door));
  for (const troupe_wire_Lift& lift : Elements(wire.lifts)) world.lifts.push_back(FromWire(lift));
  for (const troupe_wire_GoalSet& set : Elements(wire.goal_sets)) {
    if (Status failed = FromWire(set, world.goal_sets.emplace_back()); !failed.ok()) return failed.error();
  }
  for (const troupe_wire_Person& person : Elements(wire.people)) {
    if (Status failed = FromWire(person, world.people.emplace_back()); !failed.ok()) return failed.error();
  }
  if (Status invalid = Validate(world); !invalid.ok()) return invalid.error();
  return world;
}

}  // namespace troupe::dds
