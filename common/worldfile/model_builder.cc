#include "common/worldfile/model_builder.h"

#include <algorithm>

#include "common/base/random.h"
#include "common/worldfile/actuator_reader.h"
#include "common/worldfile/color_names.h"
#include "common/worldfile/entity_names.h"
#include "common/worldfile/quote.h"
#include "common/worldfile/ranger_reader.h"
#include "common/worldfile/robot_reader.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxNameLength = 1000;

Size ReadSize(PropertyReader& reader, const Size& otherwise) {
  const auto size = reader.Numbers("size", 3);
  if (!size) return otherwise;
  if (*std::min_element(size->begin(), size->end()) < 0.0) {
    reader.diagnostics().Fail(reader.Where("size"), "found a negative size, expected values of at least 0");
    return otherwise;
  }
  const double unit = reader.units().length;
  return {(*size)[0] * unit, (*size)[1] * unit, (*size)[2] * unit};
}

}  // namespace

void ModelBuilder::BuildTree() {
  BuildChildren(context_.tree.world, nullptr);
  GripperBuilder(context_).Describe(grippers_);
}

void ModelBuilder::BuildChildren(const Entity& entity, const Parent* parent) {
  const std::vector<std::string> names = ChildNames(entity);
  for (std::size_t i = 0; i < entity.children.size() && !context_.diagnostics.failed(); ++i) {
    const Entity& child = entity.children[i];
    if (child.type == "window") {
      context_.diagnostics.Warn(child.where, "'window' has no effect: it only concerns Stage's window");
    } else if (child.type == "block") {
      if (parent == nullptr)
        context_.diagnostics.Fail(child.where, "found a 'block' outside of a model, expected it inside one");
    } else if (child.type == "sensor") {
      if (parent == nullptr || parent->type != "ranger") {
        context_.diagnostics.Fail(child.where, "found a 'sensor' outside of a ranger, expected it inside one");
      }
    } else {
      BuildModel(child, FullName(parent != nullptr ? parent->name : "", names[i]), parent);
    }
  }
}

void ModelBuilder::BuildModel(const Entity& entity, const std::string& name, const Parent* parent) {
  const TypeDefaults* const type = FindType(entity.type);
  if (type == nullptr) {
    std::string message = UnknownTypeMessage(entity.type);
    const auto later = context_.tree.defines.find(entity.type);
    if (later != context_.tree.defines.end()) {
      message = "found " + Quoted(entity.type) + " before its define at line " +
                std::to_string(later->second.where.line) + ", expected the define first";
    }
    context_.diagnostics.Fail(entity.where, message);
    return;
  }
  PropertyReader reader(entity, context_.units, context_.diagnostics);
  WorldDescription& world = context_.loaded.world;
  CheckName(entity, name);
  reader.Use("name");

  ModelDescription model;
  model.name = name;
  model.type = entity.type;
  const std::optional<RosMap> map = ReadRosMap(reader, context_);
  const Size size = ReadSize(reader, map ? map->size : type->size);
  model.size_x = size.x;
  model.size_y = size.y;
  model.size_z = size.z;
  const Pose origin = reader.ReadPose("origin").value_or(Pose{});
  Pose X_PM = reader.ReadPose("pose").value_or(map ? map->origin : Pose{});
  if (parent != nullptr) X_PM.z += parent->stack_height;
  const Pose X_WM = parent != nullptr ? parent->X_WP * X_PM : X_PM;

  if (!IsWithinReach(X_PM) || !IsWithinReach(X_WM)) {
    context_.diagnostics.Fail(reader.Where("pose"), "found a model beyond 1000 km, expected it nearer");
    return;
  }

  const bool is_position = entity.type == "position";
  const bool in_robot = parent != nullptr && parent->robot;
  if (is_position && parent != nullptr && !in_robot) {
    context_.diagnostics.Warn(entity.where,
                              "a 'position' below a model that does not move is placed in the world by itself");
  }
  model.obstacle_return = reader.Flag("obstacle_return", true);
  model.ranger_return = reader.Number("ranger_return", 1.0);
  model.gripper_return = reader.Flag("gripper_return", false);
  const bool is_object = model.gripper_return && !is_position && !in_robot;
  if (model.gripper_return && !is_object) {
    context_.diagnostics.Warn(reader.Where("gripper_return"),
                              "property 'gripper_return' has no effect on a robot: none of its parts can be taken");
  }
  const ModelId id(world.models.size());
  const bool is_placed_alone = parent != nullptr && !in_robot && (is_position || is_object);
  model.X_PM = is_placed_alone ? X_WM : X_PM;
  if (is_placed_alone) context_.loaded.placed_alone.emplace(id, parent->id);
  if (parent != nullptr && !is_placed_alone) model.parent = parent->id;
  if (is_object) world.objects.push_back(id);
  ReadAppearance(reader, *type, model);
  model.fiducial_return =
      static_cast<std::int32_t>(reader.Integer("fiducial_return", 0, -1'000'000'000, 1'000'000'000));
  std::optional<RobotId> robot;
  if (parent != nullptr) robot = parent->robot;
  const std::optional<GripperSettings> gripper =
      entity.type == "gripper" ? ReadGripperOf(reader, size, X_WM, robot) : std::nullopt;
  model.shape = context_.shapes.Add(ReadShape(reader, *type, map, size, origin, gripper));
  WarnIfNotSimulated(entity, *type);
  WarnIfSeenButNotHit(reader, model);

  if (is_position) {
    if (robot) {
      context_.diagnostics.Warn(entity.where, "a 'position' on a robot moves with it; its own drive is not simulated");
      ReadDrive(reader);
      ReadLocalization(reader, X_WM, *robot, 0);
      reader.Use("ctrl");
    } else {
      robot = AddRobot(reader, model, id);
    }
  } else if (const Property* control = reader.Use("ctrl")) {
    context_.diagnostics.Warn(control->where, "property 'ctrl' has no effect: only a 'position' has a controller");
  }
  if (entity.type == "ranger") AddRanger(reader, origin, model, id, robot);
  if (entity.type == "actuator") AddActuator(reader, model, id, robot);
  const bool stack_children = reader.Flag("stack_children", true);
  WarnOfUnused(reader, entity.type);
  world.models.push_back(model);
  if (gripper) AddGripper(entity, *gripper, size, origin, id, *robot);

  const Parent self{id, name, entity.type, X_WM, stack_children ? size.z : 0.0, robot};
  BuildChildren(entity, &self);
}

void ModelBuilder::ReadAppearance(PropertyReader& reader, const TypeDefaults& type, ModelDescription& model) {
  model.color = type.color;
  model.show_nose = reader.Flag("gui_nose", false);
  if (reader.entity().Find("color") != nullptr) {
    const std::string name = reader.Text("color", "red");
    if (name == "random") {
      constexpr std::uint64_t kStream = 0x636f6c6f72;  // "color"
      const std::uint64_t number = context_.loaded.world.models.size();
      const auto draw = [&](std::uint64_t channel) {
        return RandomUniform({context_.loaded.world.seed, kStream, number, channel});
      };
      model.color = {draw(0), draw(1), draw(2), 1.0};
    } else if (const std::optional<Color> color = FindColor(name)) {
      model.color = *color;
    } else {
      context_.diagnostics.Warn(reader.Where("color"), "colour " + Quoted(name) + " is not known; red is used");
      model.color = Color{};
    }
    if (const Property* unused = reader.Use("color_rgba")) {
      context_.diagnostics.Warn(unused->where, "property 'color_rgba' has no effect beside 'color'");
    }
  } else if (const auto rgba = reader.Numbers("color_rgba", 4)) {
    const std::vector<double>& c = *rgba;
    if (*std::min_element(c.begin(), c.end()) < 0.0 || *std::max_element(c.begin(), c.end()) > 1.0) {
      context_.diagnostics.Warn(reader.Where("color_rgba"), "found a colour beyond 0 to 1; it is clamped");
    }
    const auto clamp = [](double value) { return std::clamp(value, 0.0, 1.0); };
    model.color = {clamp(c[0]), clamp(c[1]), clamp(c[2]), clamp(c[3])};
  }
}

RobotId ModelBuilder::AddRobot(PropertyReader& reader, const ModelDescription& model, ModelId id) {
  std::vector<RobotDescription>& robots = context_.loaded.world.robots;
  const RobotId robot_id(robots.size());
  RobotDescription robot;
  robot.name = model.name;
  robot.root = id;
  robot.drive = ReadDrive(reader);
  robot.localization = ReadLocalization(reader, model.X_PM, robot_id, context_.loaded.world.seed);
  if (const std::optional<ControllerDescription> controller = ReadController(reader)) {
    robot.controller = *controller;
  } else if (context_.overrides.controller) {
    robot.controller.name = *context_.overrides.controller;
  }
  robots.push_back(std::move(robot));
  return robot_id;
}

void ModelBuilder::AddRanger(PropertyReader& reader, const Pose& origin, const ModelDescription& model, ModelId id,
                             std::optional<RobotId> robot) {
  RangerDescription ranger = ReadRanger(reader, origin, context_.loaded.world.interval_ns);
  if (!robot) {
    context_.diagnostics.Warn(reader.entity().where, "this ranger is on no robot, so it measures nothing");
    return;
  }
  RobotDescription& owner = context_.loaded.world.robots[robot->index()];
  const std::string prefix = owner.name + ".";
  ranger.name = model.name.starts_with(prefix) ? model.name.substr(prefix.size()) : model.name;
  ranger.model = id;
  owner.rangers.push_back(std::move(ranger));
}

void ModelBuilder::AddActuator(PropertyReader& reader, const ModelDescription& model, ModelId id,
                               std::optional<RobotId> robot) {
  if (!robot) {
    ReadStandingActuator(reader);
    return;
  }
  WorldDescription& world = context_.loaded.world;
  JointDescription joint = ReadActuator(reader);
  joint.robot = *robot;
  joint.model = id;
  joint.name = NameOnRobot(world, *robot, model.name);
  world.joints.push_back(std::move(joint));
}

// Nothing for a gripper on no robot, which is only a body.
std::optional<GripperSettings> ModelBuilder::ReadGripperOf(PropertyReader& reader, const Size& size, const Pose& X_WM,
                                                           std::optional<RobotId> robot) {
  const WorldDescription& world = context_.loaded.world;
  const double base = robot ? world.model(world.robot(*robot).root).X_PM.z : X_WM.z;
  const GripperSettings settings = ReadGripper(reader, size, X_WM.z - base);
  if (robot) return settings;
  context_.diagnostics.Warn(reader.entity().where, "this gripper is on no robot, so it is only a body");
  return std::nullopt;
}

void ModelBuilder::AddGripper(const Entity& entity, GripperSettings settings, const Size& size, const Pose& origin,
                              ModelId id, RobotId robot) {
  GripperDraft draft{entity.where, id, robot, std::move(settings), std::nullopt};
  if (draft.settings.paddles) {
    draft.own = AddPaddles(*draft.settings.paddles, size, origin, entity.where, id, robot, context_);
    for (const ModelId part : draft.own->models) CheckName(entity, context_.loaded.world.model(part).name);
  }
  grippers_.push_back(std::move(draft));
}

Shape ModelBuilder::ReadShape(PropertyReader& reader, TypeDefaults type, const std::optional<RosMap>& map,
                              const Size& size, const Pose& origin, const std::optional<GripperSettings>& gripper) {
  if (map) return RosMapShape(reader, *map, size, origin);
  if (!gripper) return ReadModelShape(reader, type, size, origin, context_);
  if (gripper->paddles) {
    const PaddleSettings& paddles = *gripper->paddles;
    type.has_body = paddles.size.x < size.x;
    return ReadModelShape(reader, type, BackSize(size, paddles), BackOrigin(origin, paddles), context_);
  }
  type.has_body = false;  // what is there beside its parts is said by blocks
  return ReadModelShape(reader, type, size, origin, context_);
}

void ModelBuilder::CheckName(const Entity& entity, const std::string& name) {
  const Property* given = entity.Find("name");
  const SourceLocation& where = given != nullptr ? given->value.where : entity.where;
  if (given != nullptr && !std::holds_alternative<std::string>(given->value.content)) {
    context_.diagnostics.Fail(where, "found a name that is not a string, expected it in quotes");
  } else if (name.empty() || name.back() == '.') {
    context_.diagnostics.Fail(where, "found an empty name, expected at least one character");
  } else if (name.size() > kMaxNameLength) {
    context_.diagnostics.Fail(where, "found a name of " + std::to_string(name.size()) + " bytes, expected at most " +
                                         std::to_string(kMaxNameLength));
  } else if (const auto [first, is_new] = names_.emplace(name, where); !is_new) {
    context_.diagnostics.Fail(where, "found name " + Quoted(name) + " twice, expected each name once (first at " +
                                         first->second.file + ":" + std::to_string(first->second.line) + ")");
  }
}

void ModelBuilder::WarnIfNotSimulated(const Entity& entity, const TypeDefaults& type) {
  const std::string written = entity.macros.empty() ? entity.type : entity.macros.front();
  if (type.is_simulated || !warned_types_.insert(written).second) return;
  const std::string base = "'" + entity.type + "' models are not simulated yet";
  context_.diagnostics.Warn(entity.where, entity.macros.empty() ? base + "; they are only bodies"
                                                                : Quoted(written) + " is only a body: " + base);
}

void ModelBuilder::WarnIfSeenButNotHit(PropertyReader& reader, const ModelDescription& model) {
  if (model.obstacle_return || model.ranger_return < 0.0 || reader.entity().Find("bitmap") == nullptr) return;
  context_.diagnostics.Warn(reader.Where("obstacle_return"),
                            "map " + Quoted(model.name) + " is seen but never hit: its 'obstacle_return' is 0");
}

}  // namespace troupe
