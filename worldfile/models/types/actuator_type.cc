// `actuator`: a model that a joint moves, if it is a part of a robot. A linear one shifts along a unit vector in its
// own frame, a rotational one turns about the vertical, because a pose has a heading and no other angle. Limits and
// start are m or rad from the pose of the file.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "worldfile/models/types/model_types.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// A unit vector in the model's frame.
struct Axis {
  Vec2 xy{0.0, 0.0};
  double z = 1.0;
};

// Nothing for a linear actuator without a direction, which does not move in Stage either.
std::optional<Axis> ReadAxis(PropertyReader& reader, JointType type) {
  const auto axis = reader.Numbers("axis", 3);
  if (type == JointType::kRevolute) {
    if (axis && ((*axis)[0] != 0.0 || (*axis)[1] != 0.0 || !((*axis)[2] > 0.0))) {
      reader.diagnostics().Warn(reader.Where("axis"), "a rotational actuator turns about the vertical, [0 0 1]");
    }
    return Axis{};
  }
  // Divided by the largest part first: the squares of tiny or huge numbers would vanish or overflow.
  const double largest = axis ? std::max({std::fabs((*axis)[0]), std::fabs((*axis)[1]), std::fabs((*axis)[2])}) : 0.0;
  if (!(largest > 0.0)) {
    reader.diagnostics().Warn(
        reader.Where("axis"),
        axis ? "found axis [0 0 0], expected a direction; this actuator does not move"
             : "found a linear actuator without 'axis', expected its direction [x y z]; it does not move");
    return std::nullopt;
  }
  const double x = (*axis)[0] / largest;
  const double y = (*axis)[1] / largest;
  const double z = (*axis)[2] / largest;
  const double length = std::sqrt(x * x + y * y + z * z);
  return Axis{{x / length, y / length}, z / length};
}

// In m or rad, and per second.
struct Limits {
  Interval position;
  double start = 0.0;
  double max_speed = 1.0;
};

Limits ReadLimits(PropertyReader& reader, JointType type) {
  double min = reader.Number("min_position", 0.0);
  double max = reader.Number("max_position", 1.0);
  if (min > max) {
    const bool max_is_given = reader.node().Find("max_position") != nullptr;
    reader.diagnostics().Warn(reader.Where(max_is_given ? "max_position" : "min_position"),
                              "found a 'max_position' of " + NumberText(max) + " below the 'min_position' of " +
                                  NumberText(min) + ", expected the other way round; they are exchanged");
    std::swap(min, max);
  }
  const double given = reader.Number("start_position", std::clamp(0.0, min, max));
  const double start = std::clamp(given, min, max);
  if (start != given) {
    reader.WarnOfValue(*reader.Use("start_position"), NumberText(given), NumberText(min) + " to " + NumberText(max),
                       NumberText(start));
  }
  const auto scaled = [&](double value) {
    return type == JointType::kRevolute ? reader.units().Angle(value) : value * reader.units().length;
  };
  return {{scaled(min), scaled(max)}, scaled(start), scaled(reader.Number("max_speed", 1.0, 0.0))};
}

class ActuatorReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    if (draft.robot) {
      AddJoint(reader, draft, context.world);
      return;
    }
    reader.diagnostics().Warn(draft.node.where, "this actuator is on no robot, so it does not move");
    const JointType type = reader.Choice<JointType>("type");
    reader.Use("axis");
    ReadLimits(reader, type);
  }

 private:
  static void AddJoint(PropertyReader& reader, const ModelDraft& draft, WorldDescription& world) {
    JointDescription joint;
    joint.type = reader.Choice<JointType>("type");
    const std::optional<Axis> axis = ReadAxis(reader, joint.type);
    const Limits limits = ReadLimits(reader, joint.type);
    if (!axis) return;
    joint.axis_xy = axis->xy;
    joint.axis_z = axis->z;
    joint.position = limits.position;
    joint.start = limits.start;
    joint.max_speed = limits.max_speed;
    joint.robot = *draft.robot;
    joint.model = draft.id;
    joint.name = NameOnRobot(world, *draft.robot, draft.model.name);
    world.joints.push_back(std::move(joint));
  }
};

}  // namespace

ModelType ActuatorType() {
  return {.name = "actuator", .make_reader = MakeReader<ActuatorReader>};
}

}  // namespace troupe
