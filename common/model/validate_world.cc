// The invariants of a world description; see world_description.h.
#include <cmath>
#include <initializer_list>
#include <set>

#include "common/model/world_description.h"

namespace troupe {
namespace {

// No coordinate, speed or size may be larger: beyond, a double has no room left for the touch tolerance.
constexpr double kMaxMagnitude = 1e6;
constexpr std::uint32_t kMaxSamples = 1'000'000;
constexpr std::int64_t kMaxInterval_ns = 1'000'000'000'000;

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

std::string CheckShape(const Shape& shape) {
  for (const Block& block : shape.blocks) {
    Polygon outline = block.outline;
    const std::string problem = Normalize(outline);
    if (!problem.empty()) return "the outline of a block is not usable: " + problem;
    if (outline != block.outline) return "the outline of a block is not normalized";
    if (!IsUsable(block.z)) return "the height interval of a block is not finite or upside down";
  }
  for (const Rectangle& rectangle : shape.rectangles) {
    if (!IsUsable(rectangle)) return "a rectangle is not finite or has no area";
  }
  if (!IsUsable(shape.rectangles_z)) return "the height interval of the rectangles is not finite or upside down";
  return "";
}

std::string CheckModel(const WorldDescription& world, std::size_t index, std::set<std::string>& names) {
  const ModelDescription& model = world.models[index];
  if (model.name.empty()) return "it has no name";
  if (!model.removed && !names.insert(model.name).second) return "another model has the same name";
  if (model.parent && model.parent->index() >= index) return "its parent does not come before it";
  if (model.shape.index() >= world.shapes.size()) return "it names a shape that does not exist";
  if (!IsUsable(model.X_PM)) return "its pose is not finite or too far away";
  if (!AreUsable({model.size_x, model.size_y, model.size_z})) return "its size is not finite or too large";
  if (!AreUsable({model.color.r, model.color.g, model.color.b, model.color.a})) return "its color is not finite";
  if (!AreUsable({model.ranger_return})) return "its ranger_return is not finite or too large";
  return "";
}

std::string CheckSensor(const RaySensorDescription& sensor) {
  if (!IsUsable(sensor.X_MS)) return "the pose of a sensor is not finite or too far away";
  if (!IsUsable(sensor.range) || sensor.range.min < 0.0) return "the range of a sensor is not an interval from 0 up";
  if (!AreUsable({sensor.fov}) || sensor.fov < 0.0) return "the fov of a sensor is not finite or negative";
  if (sensor.samples < 1 || sensor.samples > kMaxSamples) return "a sensor does not have 1 to 1000000 samples";
  if (!AreUsable({sensor.noise_variance, sensor.noise_proportional, sensor.noise_angle}) ||
      sensor.noise_variance < 0.0) {
    return "the noise of a sensor is not finite or its variance negative";
  }
  return "";
}

std::string CheckRobot(const WorldDescription& world, std::size_t index) {
  const RobotDescription& robot = world.robots[index];
  if (robot.root.index() >= world.models.size()) return "its root model does not exist";
  if (index > 0 && robot.root <= world.robots[index - 1].root) return "it is not in the order of the root models";
  const ModelDescription& root = world.model(robot.root);
  if (root.parent) return "its root model has a parent";
  if (robot.name != root.name) return "its root model has another name: '" + root.name + "'";
  const DriveDescription& drive = robot.drive;
  if (!AreUsable({drive.wheelbase}) || drive.wheelbase <= 0.0) return "its wheelbase is not a positive number";
  if (!IsUsable(drive.velocity)) return "its velocity bounds are not intervals";
  for (const Interval& bound : {drive.acceleration.x, drive.acceleration.y, drive.acceleration.heading}) {
    if (!IsUsableAcceleration(bound)) return "its acceleration bounds are not intervals around 0";
  }
  const LocalizationDescription& localization = robot.localization;
  if (!IsUsable(localization.origin)) return "its localization origin is not finite or too far away";
  if (!AreUsable({localization.error_x, localization.error_y, localization.error_heading})) {
    return "its odometry errors are not finite or too large";
  }
  for (const RangerDescription& ranger : robot.rangers) {
    if (ranger.model.index() >= world.models.size() || !IsInTree(world, ranger.model, robot.root)) {
      return "its ranger '" + ranger.name + "' is not one of its models";
    }
    if (ranger.period_ticks < 1) return "its ranger '" + ranger.name + "' has a period of no ticks";
    for (const RaySensorDescription& sensor : ranger.sensors) {
      const std::string problem = CheckSensor(sensor);
      if (!problem.empty()) return "ranger '" + ranger.name + "': " + problem;
    }
  }
  return "";
}

std::string CheckJoint(const WorldDescription& world, std::size_t index) {
  const JointDescription& joint = world.joints[index];
  if (joint.robot.index() >= world.robots.size()) return "it is of a robot that does not exist";
  if (joint.model.index() >= world.models.size()) return "its model does not exist";
  if (index > 0 && joint.model <= world.joints[index - 1].model) return "it is not in the order of the models";
  const ModelId root = world.robot(joint.robot).root;
  if (joint.model == root || !IsInTree(world, joint.model, root)) return "its model is not below its robot's root";
  if (joint.name.empty()) return "it has no name";
  if (!AreUsable({joint.axis_xy.x(), joint.axis_xy.y(), joint.axis_z}) ||
      std::abs(joint.axis_xy.squaredNorm() + joint.axis_z * joint.axis_z - 1.0) > 1e-9) {
    return "its axis is not a unit vector";
  }
  if (joint.type == JointType::kRevolute && joint.axis_z != 1.0) return "it turns about an axis that is not vertical";
  if (!IsUsable(joint.position)) return "its limits are not an interval";
  if (!(joint.start >= joint.position.min && joint.start <= joint.position.max)) {
    return "its start is not within its limits";
  }
  if (!AreUsable({joint.max_speed}) || joint.max_speed < 0.0) return "its speed is not finite or negative";
  return "";
}

bool IsMovedBy(const WorldDescription& world, ModelId model, JointId joint) {
  return IsInTree(world, model, world.joint(joint).model);
}

std::string CheckGripper(const WorldDescription& world, std::size_t index) {
  const GripperDescription& gripper = world.grippers[index];
  if (gripper.robot.index() >= world.robots.size()) return "it is of a robot that does not exist";
  for (ModelId model : {gripper.model, gripper.left_pad, gripper.right_pad}) {
    if (model.index() >= world.models.size() || !IsInTree(world, model, world.robot(gripper.robot).root)) {
      return "one of its models is not its robot's";
    }
  }
  if (index > 0 && gripper.model <= world.grippers[index - 1].model) return "it is not in the order of the models";
  for (JointId joint : {gripper.left, gripper.right, gripper.lift.value_or(gripper.left)}) {
    if (joint.index() >= world.joints.size() || world.joint(joint).robot != gripper.robot) {
      return "one of its joints is not its robot's";
    }
  }
  if (gripper.left == gripper.right || gripper.lift == gripper.left || gripper.lift == gripper.right) {
    return "one joint has two parts in it";
  }
  if (!IsMovedBy(world, gripper.left_pad, gripper.left) || !IsMovedBy(world, gripper.right_pad, gripper.right)) {
    return "a finger does not move its pad";
  }
  if (gripper.lift && !IsMovedBy(world, gripper.model, *gripper.lift)) return "its lift does not move it";
  for (const BreakBeam& beam : gripper.beams) {
    if (!AreUsable({beam.from.x(), beam.from.y(), beam.to.x(), beam.to.y(), beam.z})) {
      return "one of its beams is not finite or too long";
    }
  }
  return "";
}

std::string CheckObject(const WorldDescription& world, std::size_t index) {
  const ModelId object = world.objects[index];
  if (object.index() >= world.models.size()) return "its model does not exist";
  if (index > 0 && object <= world.objects[index - 1]) return "it is not in order";
  const ModelDescription& model = world.model(object);
  if (model.parent || !model.gripper_return) return "it has a parent or no gripper_return";
  for (const RobotDescription& robot : world.robots) {
    if (robot.root == object) return "it is a robot";
  }
  return "";
}

Status Problem(const std::string& what) {
  return Error{.where = {}, .message = what};
}

}  // namespace

Status Validate(const WorldDescription& world) {
  if (world.interval_ns < 1 || world.interval_ns > kMaxInterval_ns) {
    return Problem("found a tick of " + std::to_string(world.interval_ns) + " ns, expected 1 to " +
                   std::to_string(kMaxInterval_ns));
  }
  for (std::size_t i = 0; i < world.shapes.size(); ++i) {
    const std::string problem = CheckShape(world.shapes[i]);
    if (!problem.empty()) return Problem("shape " + std::to_string(i) + ": " + problem);
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const std::string problem = CheckModel(world, i, names);
    if (!problem.empty()) return Problem("model " + std::to_string(i) + " '" + world.models[i].name + "': " + problem);
  }
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const std::string problem = CheckRobot(world, i);
    if (!problem.empty()) return Problem("robot " + std::to_string(i) + " '" + world.robots[i].name + "': " + problem);
  }
  for (std::size_t i = 0; i < world.joints.size(); ++i) {
    const std::string problem = CheckJoint(world, i);
    if (!problem.empty()) return Problem("joint " + std::to_string(i) + " '" + world.joints[i].name + "': " + problem);
  }
  for (std::size_t i = 0; i < world.grippers.size(); ++i) {
    const std::string problem = CheckGripper(world, i);
    if (!problem.empty()) {
      return Problem("gripper " + std::to_string(i) + " '" + world.grippers[i].name + "': " + problem);
    }
  }
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const std::string problem = CheckObject(world, i);
    if (!problem.empty()) return Problem("object " + std::to_string(i) + ": " + problem);
  }
  if (!AreUsable({world.gravity}) || world.gravity < 0.0) return Problem("its gravity is not finite or negative");
  return std::nullopt;
}

}  // namespace troupe
