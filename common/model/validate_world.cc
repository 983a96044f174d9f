// The invariants of a world description, see world_description.h: the limits of its fields, and the rules between
// several of them.
//
// A description comes from a file, from the API or from the network. All code behind the check may rely on it: indices
// exist, parents come first, tables are in the order of their models, shapes are normalized. The order of the checks
// matters: each relies on the earlier ones (IsInTree ends because parents precede).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "common/geometry/limits.h"
#include "common/model/field_check.h"
#include "common/model/validate_site.h"
#include "troupe/world_description.h"

namespace troupe {
namespace {

// The problem of one part of the world, with that part's number, and its name if that kind has names.
Status InPart(const Status& problem, const std::string& kind, std::size_t index,
              const std::optional<std::string>& name = std::nullopt) {
  if (problem.ok()) return problem;
  const std::string part = kind + " " + std::to_string(index) + (name ? " '" + *name + "'" : "");
  return BadInput(part + ": " + problem.error().message);
}

Status CheckShape(const Shape& shape) {
  for (const Block& block : shape.blocks) {
    const Result<Polygon> outline = Normalized(block.outline);
    if (!outline.ok()) return BadInput("the outline of a block is not usable: " + outline.error().message);
    // Normalized once by the maker: indices compute with the outline as it is.
    if (outline.value() != block.outline) return BadInput("the outline of a block is not normalized");
  }
  for (const Rectangle& rectangle : shape.rectangles) {
    if (!(rectangle.min_x < rectangle.max_x && rectangle.min_y < rectangle.max_y)) {
      return BadInput("a rectangle has no area");
    }
  }
  if (!shape.area) return Status();
  if (!shape.rectangles.empty()) return BadInput("it has both rectangles and the area of a bitmap");
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
    return InPart(BadInput("it moves, so its bitmap must be a list of rectangles"), "model", i, model.name);
  }
  return Status();
}

Status CheckModel(const WorldDescription& world, std::size_t index) {
  const ModelDescription& model = world.models[index];
  if (model.name.empty()) return BadInput("it has no name");
  if (model.parent && model.parent->index() >= index) return BadInput("its parent does not precede it");
  if (model.power.joules > model.power.capacity) return BadInput("it stores more energy than its capacity");
  if (model.blinking.on_ns > model.blinking.period_ns) return BadInput("its light is on for longer than its period");
  const MapGrid& map = model.map;
  const bool is_map = map.columns > 0 || map.rows > 0;
  if (is_map && !(map.columns > 0 && map.rows > 0 && map.resolution > 0.0 &&
                  std::max(map.columns, map.rows) * map.resolution <= kMaxMagnitude)) {
    return BadInput("its map has no extent, or is too large");
  }
  return Status();
}

Status CheckSensor(const WorldDescription& world, const RobotDescription& robot, const SensorDescription& sensor) {
  const std::string name = std::string(TypeOf(sensor.parameters)) + " '" + sensor.name + "'";
  if (!IsInTree(world, sensor.model, robot.root)) return BadInput("its " + name + " is not one of its models");
  const Status error = CheckParameters(sensor.parameters);
  return error.ok() ? error : BadInput(name + ": " + error.error().message);
}

Status CheckRobot(const WorldDescription& world, std::size_t index) {
  const RobotDescription& robot = world.robots[index];
  if (index > 0 && robot.root <= world.robots[index - 1].root)
    return BadInput("it is not in the order of the root models");
  const ModelDescription& root = world.model(robot.root);
  if (root.parent) return BadInput("its root model has a parent");
  if (robot.name != root.name) return BadInput("its root model has another name: '" + root.name + "'");
  const TwistBounds& acceleration = robot.drive.acceleration;
  for (const Interval& bound : {acceleration.x, acceleration.y, acceleration.heading}) {
    if (!bound.Contains(0.0)) return BadInput("its acceleration bounds are not intervals around 0");
  }
  for (const SensorDescription& sensor : robot.sensors) {
    if (Status error = CheckSensor(world, robot, sensor); !error.ok()) return error;
  }
  for (const MountedFrame& frame : robot.frames) {
    if (!IsInTree(world, frame.model, robot.root))
      return BadInput("its frame '" + frame.name + "' is on no model of it");
  }
  return Status();
}

Status CheckJoint(const WorldDescription& world, std::size_t index) {
  const JointDescription& joint = world.joints[index];
  if (index > 0 && joint.model <= world.joints[index - 1].model)
    return BadInput("it is not in the order of the models");
  const ModelId root = world.robot(joint.robot).root;
  if (joint.model == root || !IsInTree(world, joint.model, root))
    return BadInput("its model is not below its robot's root");
  if (joint.name.empty()) return BadInput("it has no name");
  if (std::abs(joint.axis_xy.squaredNorm() + joint.axis_z * joint.axis_z - 1.0) > 1e-9) {
    return BadInput("its axis is not a unit vector");
  }
  if (joint.type == JointType::kRevolute && joint.axis_z != 1.0)
    return BadInput("it turns about an axis that is not vertical");
  return joint.position.Contains(joint.start) ? Status() : BadInput("its start is not within its limits");
}

bool IsMovedBy(const WorldDescription& world, ModelId model, JointId joint) {
  return IsInTree(world, model, world.joint(joint).model);
}

Status CheckGripper(const WorldDescription& world, std::size_t index) {
  const GripperDescription& gripper = world.grippers[index];
  for (ModelId model : {gripper.model, gripper.left_pad, gripper.right_pad}) {
    if (!IsInTree(world, model, world.robot(gripper.robot).root)) {
      return BadInput("one of its models is not its robot's");
    }
  }
  if (index > 0 && gripper.model <= world.grippers[index - 1].model)
    return BadInput("it is not in the order of the models");
  for (JointId joint : {gripper.left, gripper.right, gripper.lift.value_or(gripper.left)}) {
    if (world.joint(joint).robot != gripper.robot) return BadInput("one of its joints is not its robot's");
  }
  if (gripper.left == gripper.right || gripper.lift == gripper.left || gripper.lift == gripper.right) {
    return BadInput("one joint has two parts in it");
  }
  if (!IsMovedBy(world, gripper.left_pad, gripper.left) || !IsMovedBy(world, gripper.right_pad, gripper.right)) {
    return BadInput("a finger does not move its pad");
  }
  if (gripper.lift && !IsMovedBy(world, gripper.model, *gripper.lift)) return BadInput("its lift does not move it");
  return Status();
}

// `is_leaf`: by object; the leaves of the doors before this one.
Status CheckDoor(const WorldDescription& world, std::size_t index, std::vector<bool>& is_leaf) {
  const DoorDescription& door = world.doors[index];
  if (index > 0 && door.model <= world.doors[index - 1].model) return BadInput("it is not in the order of the models");
  if (door.leaves.empty()) return BadInput("it has no leaf");
  for (const DoorLeaf& leaf : door.leaves) {
    if (is_leaf[leaf.object.index()]) return BadInput("an object is a leaf twice");
    is_leaf[leaf.object.index()] = true;
    if (leaf.turn != 0.0 && leaf.shift != 0.0) return BadInput("a leaf both turns and slides");
  }
  return Status();
}

// `is_mounted`: by object; leaves, and the cabins of the lifts before this one.
Status CheckLift(const WorldDescription& world, std::size_t index, std::vector<bool>& is_mounted) {
  const LiftDescription& lift = world.lifts[index];
  if (index > 0 && lift.model <= world.lifts[index - 1].model) return BadInput("it is not in the order of the models");
  if (is_mounted[lift.cabin.index()]) return BadInput("its cabin is one of another lift or a leaf");
  is_mounted[lift.cabin.index()] = true;
  if (lift.floor >= lift.floors.size()) return BadInput("its floor at load does not exist");
  const auto is_door = [&](std::size_t door) { return door < world.doors.size(); };
  if (!std::all_of(lift.cabin_doors.begin(), lift.cabin_doors.end(), is_door))
    return BadInput("it has an unknown door");
  for (const LiftFloor& floor : lift.floors) {
    if (!std::all_of(floor.doors.begin(), floor.doors.end(), is_door)) return BadInput("it has an unknown door");
  }
  return Status();
}

Status CheckObject(const WorldDescription& world, std::size_t index, bool is_mounted) {
  const ModelId object = world.objects[index];
  if (index > 0 && object <= world.objects[index - 1]) return BadInput("it is not in order");
  const ModelDescription& model = world.model(object);
  if (model.parent || !(model.gripper_return || is_mounted)) return BadInput("it has a parent or no gripper_return");
  for (const RobotDescription& robot : world.robots) {
    if (robot.root == object) return BadInput("it is a robot");
  }
  return Status();
}

Status CheckGoalSet(const WorldDescription& world, const GoalSet& set) {
  if (!set.heights.empty() && set.heights.size() != set.points.size()) {
    return BadInput("it has heights of some of its points only");
  }
  for (const NextGoals& next : set.next) {
    if (next.goals >= world.goal_sets.size()) return BadInput("it is followed by a goal set that does not exist");
  }
  return Status();
}

Status CheckPerson(const WorldDescription& world, std::size_t index) {
  const PersonDescription& person = world.people[index];
  if (index > 0 && person.root <= world.people[index - 1].root) return BadInput("it is not in the order of the models");
  if (world.model(person.root).parent) return BadInput("its model has a parent");
  const bool is_robot = std::any_of(world.robots.begin(), world.robots.end(),
                                    [&](const RobotDescription& robot) { return robot.root == person.root; });
  if (is_robot || std::find(world.objects.begin(), world.objects.end(), person.root) != world.objects.end()) {
    return BadInput("its model is that of a robot or an object");
  }
  if (person.speed > person.max_speed) return BadInput("its speed is above its highest one");
  if (person.goals >= world.goal_sets.size()) return BadInput("its goal set does not exist");
  if (!person.leader) return Status();
  if (person.leader->index() >= index) return BadInput("its leader does not precede it");
  return world.person(*person.leader).leader ? BadInput("its leader follows another person") : Status();
}

// Each value is above the one before.
template <typename Value>
bool Ascend(const std::vector<Value>& values) {
  return std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end();
}

Status CheckVisitorFlow(const VisitorFlow& flow) {
  if (flow.times.empty() || flow.times.front() != 0.0) return BadInput("its time table does not begin at 0");
  if (flow.per_hour.size() != flow.times.size()) return BadInput("it has rates of some of its times only");
  if (!Ascend(flow.times)) return BadInput("the times of its table do not ascend");
  const bool is_within = std::all_of(flow.per_hour.begin(), flow.per_hour.end(),
                                     [](double rate) { return rate >= 0.0 && rate <= kMaxVisitorsPerHour; });
  return is_within ? Status() : BadInput("one of its rates is beyond the bounds");
}

Status CheckVisitor(const WorldDescription& world, std::size_t index) {
  const VisitorDescription& visitor = world.visitors[index];
  if (index > 0 && !(world.visitors[index - 1].person < visitor.person)) {
    return BadInput("it is not in the order of the people");
  }
  if (visitor.flow && *visitor.flow >= world.visitor_flows.size()) return BadInput("its flow does not exist");
  if (visitor.track.size() != visitor.track_times.size()) return BadInput("it has times of some of its positions only");
  return Ascend(visitor.track_times) ? Status() : BadInput("the times of its positions do not ascend");
}

Status CheckExits(const WorldDescription& world) {
  if (!Ascend(world.exits)) return BadInput("found exits that do not ascend");
  if (!world.exits.empty() && world.exits.back() >= world.goal_sets.size()) {
    return BadInput("found an exit that is no goal set");
  }
  for (const ZoneDescription& zone : world.zones) {
    const bool needs_exits = zone.kind == ZoneKind::kEvacuation;
    if (needs_exits != zone.exits.has_value()) return BadInput("found exits of the wrong kind of zone, or none");
    if (zone.exits && !std::binary_search(world.exits.begin(), world.exits.end(), *zone.exits)) {
      return BadInput("found exits of a zone that are none of the world");
    }
  }
  return Status();
}

Status CheckNames(const WorldDescription& world) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    // A removed model stays in the tables, so that ids stay; its name is free again.
    if (model.removed || names.insert(model.name).second) continue;
    return InPart(BadInput("another model has the same name"), "model", i, model.name);
  }
  return Status();
}

// No two robots share a domain of their own.
Status CheckRosDomains(const WorldDescription& world) {
  std::map<std::uint32_t, std::size_t> owners;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const RobotDescription& robot = world.robots[i];
    if (!robot.ros.domain || !RobotExists(world, RobotId(i))) continue;
    const auto [owner, is_first] = owners.emplace(*robot.ros.domain, i);
    if (is_first) continue;
    return BadInput("found the ROS domain " + std::to_string(*robot.ros.domain) + " for robot '" + robot.name +
                    "', which robot '" + world.robots[owner->second].name +
                    "' has already, expected one for each robot");
  }
  return Status();
}

}  // namespace

Status Validate(const WorldDescription& world) {
  FieldCheck check(&world);
  if (!check.Check(world)) return BadInput(check.problem());
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
  for (std::size_t i = 0; i < world.visitor_flows.size(); ++i) {
    const VisitorFlow& flow = world.visitor_flows[i];
    if (Status error = InPart(CheckVisitorFlow(flow), "flow of visitors", i, flow.name); !error.ok()) return error;
  }
  for (std::size_t i = 0; i < world.visitors.size(); ++i) {
    if (Status error = InPart(CheckVisitor(world, i), "visitor", i); !error.ok()) return error;
  }
  if (Status error = CheckExits(world); !error.ok()) return error;
  if (Status error = ValidateSite(world); !error.ok()) return error;
  return CheckAreas(world);
}

}  // namespace troupe
