// The invariants of a world description; see world_description.h.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "common/geometry/limits.h"
#include "common/model/validate_site.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

bool AreUsable(std::initializer_list<double> numbers) {
  for (double number : numbers) {
    if (!(std::abs(number) <= kMaxMagnitude)) return false;
  }
  return true;
}

bool IsUsable(const Pose& pose) {
  return AreUsable({pose.x, pose.y, pose.z, pose.heading});
}

bool IsUsable(const ZRange& z) {
  return AreUsable({z.min, z.max}) && z.min <= z.max;
}

bool IsUsable(const Rectangle& r) {
  return AreUsable({r.min_x, r.min_y, r.max_x, r.max_y}) && r.min_x < r.max_x && r.min_y < r.max_y;
}

bool IsUsable(const Interval& interval) {
  return AreUsable({interval.min, interval.max}) && interval.min <= interval.max;
}

bool IsUsable(const TwistBounds& bounds) {
  return IsUsable(bounds.x) && IsUsable(bounds.y) && IsUsable(bounds.heading);
}

bool IsUsableAcceleration(const Interval& interval) {
  return IsUsable(interval) && interval.min <= 0.0 && interval.max >= 0.0;
}

Error Problem(const std::string& message) {
  return {.where = {}, .message = message};
}

// The problem of one part of the world, with that part's number, and its name if that kind has names.
Status InPart(const Status& problem, const std::string& kind, std::size_t index,
              const std::optional<std::string>& name = std::nullopt) {
  if (problem.ok()) return problem;
  const std::string part = kind + " " + std::to_string(index) + (name ? " '" + *name + "'" : "");
  return Problem(part + ": " + problem.error().message);
}

Status CheckShape(const Shape& shape) {
  for (const Block& block : shape.blocks) {
    const Result<Polygon> outline = Normalized(block.outline);
    if (!outline.ok()) return Problem("the outline of a block is not usable: " + outline.error().message);
    if (outline.value() != block.outline) return Problem("the outline of a block is not normalized");
    if (!IsUsable(block.z)) return Problem("the height interval of a block is not finite or upside down");
  }
  for (const Rectangle& rectangle : shape.rectangles) {
    if (!IsUsable(rectangle)) return Problem("a rectangle is not finite or has no area");
  }
  if (!IsUsable(shape.rectangles_z))
    return Problem("the height interval of the rectangles is not finite or upside down");
  if (!shape.area) return Status();
  if (!shape.rectangles.empty()) return Problem("it has both rectangles and the area of a bitmap");
  return shape.area->Check();
}

// REQUIRES: the models, robots and objects are valid.
Status CheckAreas(const WorldDescription& world) {
  std::vector<bool> moves(world.models.size());
  for (const RobotDescription& robot : world.robots) moves[robot.root.index()] = true;
  for (const ModelId object : world.objects) moves[object.index()] = true;
  for (const PersonDescription& person : world.people) moves[person.root.index()] = true;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.parent && moves[model.parent->index()]) moves[i] = true;
    if (!moves[i] || !world.shape(model.shape).area) continue;
    return InPart(Problem("it moves, so its bitmap must be a list of rectangles"), "model", i, model.name);
  }
  return Status();
}

Status CheckModel(const WorldDescription& world, std::size_t index) {
  const ModelDescription& model = world.models[index];
  if (model.name.empty()) return Problem("it has no name");
  if (model.parent && model.parent->index() >= index) return Problem("its parent does not precede it");
  if (model.shape.index() >= world.shapes.size()) return Problem("it names a shape that does not exist");
  if (!IsUsable(model.X_PM)) return Problem("its pose is not finite or too far away");
  if (!AreUsable({model.size_x, model.size_y, model.size_z})) return Problem("its size is not finite or too large");
  if (!AreUsable({model.color.r, model.color.g, model.color.b, model.color.a}))
    return Problem("its color is not finite");
  if (!AreUsable({model.ranger_return})) return Problem("its ranger_return is not finite or too large");
  const PowerDescription& power = model.power;
  for (const double value :
       {power.joules, power.capacity, power.watts, power.mass, power.give_watts, power.take_watts}) {
    if (!(value >= 0.0 && value <= kMaxEnergy)) return Problem("its energy is negative, not finite or too large");
  }
  if (power.joules > power.capacity) return Problem("it stores more energy than its capacity");
  const Blinking& blinking = model.blinking;
  if (blinking.period_ns < 0 || blinking.on_ns < 0 || blinking.on_ns > blinking.period_ns) {
    return Problem("its light is on for longer than its period, or for a negative time");
  }
  const MapGrid& map = model.map;
  const bool is_map = map.columns > 0 || map.rows > 0;
  if (is_map && !(map.columns > 0 && map.rows > 0 && map.resolution > 0.0 &&
                  AreUsable({map.columns * map.resolution, map.rows * map.resolution}))) {
    return Problem("its map has no extent, or is too large");
  }
  return Status();
}

Status CheckSensor(const WorldDescription& world, const RobotDescription& robot, const SensorDescription& sensor) {
  const std::string name = std::string(TypeOf(sensor.parameters)) + " '" + sensor.name + "'";
  if (sensor.model.index() >= world.models.size() || !IsInTree(world, sensor.model, robot.root)) {
    return Problem("its " + name + " is not one of its models");
  }
  if (sensor.period_ticks < 1) return Problem("its " + name + " has a period of no ticks");
  const Status error = CheckParameters(sensor.parameters);
  return error.ok() ? error : Problem(name + ": " + error.error().message);
}

Status CheckRobot(const WorldDescription& world, std::size_t index) {
  const RobotDescription& robot = world.robots[index];
  if (robot.root.index() >= world.models.size()) return Problem("its root model does not exist");
  if (index > 0 && robot.root <= world.robots[index - 1].root)
    return Problem("it is not in the order of the root models");
  const ModelDescription& root = world.model(robot.root);
  if (root.parent) return Problem("its root model has a parent");
  if (robot.name != root.name) return Problem("its root model has another name: '" + root.name + "'");
  const DriveDescription& drive = robot.drive;
  if (!AreUsable({drive.wheelbase}) || drive.wheelbase <= 0.0) return Problem("its wheelbase is not a positive number");
  if (!IsUsable(drive.velocity)) return Problem("its velocity bounds are not intervals");
  for (const Interval& bound : {drive.acceleration.x, drive.acceleration.y, drive.acceleration.heading}) {
    if (!IsUsableAcceleration(bound)) return Problem("its acceleration bounds are not intervals around 0");
  }
  const LocalizationDescription& localization = robot.localization;
  if (!IsUsable(localization.origin)) return Problem("its localization origin is not finite or too far away");
  if (!AreUsable({localization.error_x, localization.error_y, localization.error_heading})) {
    return Problem("its odometry errors are not finite or too large");
  }
  if (robot.ros.domain.value_or(0) > kLastRosDomain) {
    return Problem("found the ROS domain " + std::to_string(*robot.ros.domain) + ", expected at most " +
                   std::to_string(kLastRosDomain) + ": the ports of a higher one would exceed 65535");
  }
  for (const SensorDescription& sensor : robot.sensors) {
    if (Status error = CheckSensor(world, robot, sensor); !error.ok()) return error;
  }
  return Status();
}

Status CheckJoint(const WorldDescription& world, std::size_t index) {
  const JointDescription& joint = world.joints[index];
  if (joint.robot.index() >= world.robots.size()) return Problem("it is of a robot that does not exist");
  if (joint.model.index() >= world.models.size()) return Problem("its model does not exist");
  if (index > 0 && joint.model <= world.joints[index - 1].model) return Problem("it is not in the order of the models");
  const ModelId root = world.robot(joint.robot).root;
  if (joint.model == root || !IsInTree(world, joint.model, root))
    return Problem("its model is not below its robot's root");
  if (joint.name.empty()) return Problem("it has no name");
  if (!AreUsable({joint.axis_xy.x(), joint.axis_xy.y(), joint.axis_z}) ||
      std::abs(joint.axis_xy.squaredNorm() + joint.axis_z * joint.axis_z - 1.0) > 1e-9) {
    return Problem("its axis is not a unit vector");
  }
  if (joint.type == JointType::kRevolute && joint.axis_z != 1.0)
    return Problem("it turns about an axis that is not vertical");
  if (!IsUsable(joint.position)) return Problem("its limits are not an interval");
  if (!(joint.start >= joint.position.min && joint.start <= joint.position.max)) {
    return Problem("its start is not within its limits");
  }
  if (!AreUsable({joint.max_speed}) || joint.max_speed < 0.0) return Problem("its speed is not finite or negative");
  return Status();
}

bool IsMovedBy(const WorldDescription& world, ModelId model, JointId joint) {
  return IsInTree(world, model, world.joint(joint).model);
}

Status CheckGripper(const WorldDescription& world, std::size_t index) {
  const GripperDescription& gripper = world.grippers[index];
  if (gripper.robot.index() >= world.robots.size()) return Problem("it is of a robot that does not exist");
  for (ModelId model : {gripper.model, gripper.left_pad, gripper.right_pad}) {
    if (model.index() >= world.models.size() || !IsInTree(world, model, world.robot(gripper.robot).root)) {
      return Problem("one of its models is not its robot's");
    }
  }
  if (index > 0 && gripper.model <= world.grippers[index - 1].model)
    return Problem("it is not in the order of the models");
  for (JointId joint : {gripper.left, gripper.right, gripper.lift.value_or(gripper.left)}) {
    if (joint.index() >= world.joints.size() || world.joint(joint).robot != gripper.robot) {
      return Problem("one of its joints is not its robot's");
    }
  }
  if (gripper.left == gripper.right || gripper.lift == gripper.left || gripper.lift == gripper.right) {
    return Problem("one joint has two parts in it");
  }
  if (!IsMovedBy(world, gripper.left_pad, gripper.left) || !IsMovedBy(world, gripper.right_pad, gripper.right)) {
    return Problem("a finger does not move its pad");
  }
  if (gripper.lift && !IsMovedBy(world, gripper.model, *gripper.lift)) return Problem("its lift does not move it");
  for (const BreakBeam& beam : gripper.beams) {
    if (!AreUsable({beam.from.x(), beam.from.y(), beam.to.x(), beam.to.y(), beam.z})) {
      return Problem("one of its beams is not finite or too long");
    }
  }
  return Status();
}

// `is_leaf`: by object; those of the doors before.
Status CheckDoor(const WorldDescription& world, std::size_t index, std::vector<bool>& is_leaf) {
  const DoorDescription& door = world.doors[index];
  if (door.model.index() >= world.models.size()) return Problem("its model does not exist");
  if (index > 0 && door.model <= world.doors[index - 1].model) return Problem("it is not in the order of the models");
  if (door.leaves.empty()) return Problem("it has no leaf");
  for (const DoorLeaf& leaf : door.leaves) {
    if (leaf.object.index() >= world.objects.size()) return Problem("a leaf of it does not exist");
    if (is_leaf[leaf.object.index()]) return Problem("an object is a leaf twice");
    is_leaf[leaf.object.index()] = true;
    if (!IsUsable(leaf.X_WH) || !AreUsable({leaf.shift}) || !(std::abs(leaf.turn) <= 2.0 * kPi)) {
      return Problem("a leaf is not finite or too far away, or turns by more than once");
    }
    if (leaf.turn != 0.0 && leaf.shift != 0.0) return Problem("a leaf both turns and slides");
  }
  if (!AreUsable({door.seconds, door.reach}) || door.seconds < 1e-3 || door.reach < 0.0) {
    return Problem("its time to open is shorter than 1 ms, or its reach is negative, or one of both too large");
  }
  if (!(door.opening >= 0.0 && door.opening <= 1.0)) return Problem("its opening is not within 0 and 1");
  return Status();
}

// `is_mounted`: by object; leaves, and cabins of the lifts before.
Status CheckLift(const WorldDescription& world, std::size_t index, std::vector<bool>& is_mounted) {
  const LiftDescription& lift = world.lifts[index];
  if (lift.model.index() >= world.models.size()) return Problem("its model does not exist");
  if (index > 0 && lift.model <= world.lifts[index - 1].model) return Problem("it is not in the order of the models");
  if (lift.cabin.index() >= world.objects.size() || is_mounted[lift.cabin.index()]) {
    return Problem("its cabin does not exist, or is one of another lift or a leaf");
  }
  is_mounted[lift.cabin.index()] = true;
  if (lift.floor >= lift.floors.size()) return Problem("its floor at load does not exist");
  if (!AreUsable({lift.speed}) || !(lift.speed >= 1e-3)) return Problem("its speed is below 1 mm/s or too large");
  const auto is_door = [&](std::size_t door) { return door < world.doors.size(); };
  if (!std::all_of(lift.cabin_doors.begin(), lift.cabin_doors.end(), is_door)) return Problem("it has an unknown door");
  for (const LiftFloor& floor : lift.floors) {
    if (!AreUsable({floor.z})) return Problem("a floor of it is not finite or too far away");
    if (!std::all_of(floor.doors.begin(), floor.doors.end(), is_door)) return Problem("it has an unknown door");
  }
  return Status();
}

Status CheckObject(const WorldDescription& world, std::size_t index, bool is_mounted) {
  const ModelId object = world.objects[index];
  if (object.index() >= world.models.size()) return Problem("its model does not exist");
  if (index > 0 && object <= world.objects[index - 1]) return Problem("it is not in order");
  const ModelDescription& model = world.model(object);
  if (model.parent || !(model.gripper_return || is_mounted)) return Problem("it has a parent or no gripper_return");
  for (const RobotDescription& robot : world.robots) {
    if (robot.root == object) return Problem("it is a robot");
  }
  return Status();
}

Status CheckGoalSet(const WorldDescription& world, const GoalSet& set) {
  for (const Vec2& point : set.points) {
    if (!AreUsable({point.x(), point.y()})) return Problem("one of its points is not finite or too far away");
  }
  if (!set.heights.empty() && set.heights.size() != set.points.size()) {
    return Problem("it has heights of some of its points only");
  }
  for (const double height : set.heights) {
    if (!AreUsable({height})) return Problem("one of its heights is not finite or too far away");
  }
  if (!AreUsable({set.reach}) || set.reach <= 0.0) return Problem("its reach is not a positive number");
  if (!IsUsable(set.wait) || set.wait.min < 0.0) return Problem("its waiting times are not an interval from 0 on");
  for (const NextGoals& next : set.next) {
    if (next.goals >= world.goal_sets.size()) return Problem("it is followed by a goal set that does not exist");
    if (!AreUsable({next.weight}) || next.weight <= 0.0) return Problem("a weight is not a positive number");
  }
  return Status();
}

Status CheckPerson(const WorldDescription& world, std::size_t index) {
  const PersonDescription& person = world.people[index];
  if (person.root.index() >= world.models.size()) return Problem("its model does not exist");
  if (index > 0 && person.root <= world.people[index - 1].root) return Problem("it is not in the order of the models");
  if (world.model(person.root).parent) return Problem("its model has a parent");
  const bool is_robot = std::any_of(world.robots.begin(), world.robots.end(),
                                    [&](const RobotDescription& robot) { return robot.root == person.root; });
  if (is_robot || std::find(world.objects.begin(), world.objects.end(), person.root) != world.objects.end()) {
    return Problem("its model is that of a robot or an object");
  }
  constexpr double kMaxRadius = 10.0;  // m
  if (!(person.radius > 0.0 && person.radius <= kMaxRadius)) return Problem("its radius is not from 0 to 10 m");
  constexpr double kMaxSpeed = 100.0;  // m/s
  if (!(person.speed >= 0.0 && person.speed <= person.max_speed && person.max_speed <= kMaxSpeed)) {
    return Problem("its speed is negative, or above its highest one, or that one is above 100 m/s");
  }
  if (person.reaction > LastOf(PersonReaction())) return Problem("its reaction does not exist");
  if (person.goals >= world.goal_sets.size()) return Problem("its goal set does not exist");
  if (!person.leader) return Status();
  if (person.leader->index() >= index) return Problem("its leader does not precede it");
  return world.person(*person.leader).leader ? Problem("its leader follows another person") : Status();
}

Status CheckNames(const WorldDescription& world) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.removed || names.insert(model.name).second) continue;
    return InPart(Problem("another model has the same name"), "model", i, model.name);
  }
  return Status();
}

// A domain of its own is that of one robot.
Status CheckRosDomains(const WorldDescription& world) {
  std::map<std::uint32_t, std::size_t> owners;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const RobotDescription& robot = world.robots[i];
    if (!robot.ros.domain || !RobotExists(world, RobotId(i))) continue;
    const auto [owner, is_first] = owners.emplace(*robot.ros.domain, i);
    if (is_first) continue;
    return Problem("found the ROS domain " + std::to_string(*robot.ros.domain) + " for robot '" + robot.name +
                   "', which robot '" + world.robots[owner->second].name +
                   "' has already, expected one for each robot");
  }
  return Status();
}

}  // namespace

Status Validate(const WorldDescription& world) {
  if (world.interval_ns < 1 || static_cast<double>(world.interval_ns) > kMaxInterval_ns) {
    return Problem("found a tick of " + std::to_string(world.interval_ns) + " ns, expected 1 to " +
                   std::to_string(static_cast<std::int64_t>(kMaxInterval_ns)));
  }
  for (std::size_t i = 0; i < world.shapes.size(); ++i) {
    if (Status error = InPart(CheckShape(world.shapes[i]), "shape", i); !error.ok()) return error;
  }
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    if (Status error = InPart(CheckModel(world, i), "model", i, world.models[i].name); !error.ok()) return error;
  }
  if (Status error = CheckNames(world); !error.ok()) return error;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (Status error = InPart(CheckRobot(world, i), "robot", i, world.robots[i].name); !error.ok()) return error;
  }
  if (Status error = CheckRosDomains(world); !error.ok()) return error;
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    if (Status error = InPart(CheckJoint(world, i), "joint", i, world.joints[i].name); !error.ok()) return error;
  }
  for (std::size_t i = 0; i < world.grippers.size(); ++i) {
    if (Status error = InPart(CheckGripper(world, i), "gripper", i, world.grippers[i].name); !error.ok()) return error;
  }
  std::vector<bool> is_mounted(world.objects.size(), false);
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    if (Status error = InPart(CheckDoor(world, i, is_mounted), "door", i); !error.ok()) return error;
  }
  for (std::size_t i = 0; i < world.lifts.size(); ++i) {
    if (Status error = InPart(CheckLift(world, i, is_mounted), "lift", i); !error.ok()) return error;
  }
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (Status error = InPart(CheckObject(world, i, is_mounted[i]), "object", i); !error.ok()) return error;
  }
  for (std::size_t i = 0; i < world.goal_sets.size(); ++i) {
    const GoalSet& set = world.goal_sets[i];
    if (Status error = InPart(CheckGoalSet(world, set), "goal set", i, set.name); !error.ok()) return error;
  }
  for (std::size_t i = 0; i < world.people.size(); ++i) {
    if (Status error = InPart(CheckPerson(world, i), "person", i); !error.ok()) return error;
  }
  if (Status error = ValidateSite(world); !error.ok()) return error;
  if (Status error = CheckAreas(world); !error.ok()) return error;
  if (!AreUsable({world.gravity}) || world.gravity < 0.0) return Problem("its gravity is not finite or negative");
  return Status();
}

}  // namespace troupe
