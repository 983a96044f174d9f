#include "common/worldfile/actuator_reader.h"

#include <algorithm>
#include <cmath>

#include "common/worldfile/quote.h"

namespace troupe {
namespace {

bool ReadIsRotational(PropertyReader& reader) {
  const std::string type = reader.Text("type", "linear");
  if (type != "linear" && type != "rotational") {
    reader.diagnostics().Fail(reader.Where("type"),
                              "found type " + Quoted(type) + ", expected \"linear\" or \"rotational\"");
  }
  return type == "rotational";
}

void ReadAxis(PropertyReader& reader, JointDescription& joint) {
  const auto axis = reader.Numbers("axis", 3);
  if (reader.diagnostics().failed()) return;
  if (joint.type == JointType::kRevolute) {
    if (axis && ((*axis)[0] != 0.0 || (*axis)[1] != 0.0 || !((*axis)[2] > 0.0))) {
      reader.diagnostics().Warn(reader.Where("axis"), "a rotational actuator turns about the vertical, [0 0 1]");
    }
    return;
  }
  if (!axis) {
    reader.diagnostics().Fail(reader.entity().where,
                              "found a linear actuator without 'axis', expected its direction [x y z]");
    return;
  }
  const double largest = std::max({std::fabs((*axis)[0]), std::fabs((*axis)[1]), std::fabs((*axis)[2])});
  if (!(largest > 0.0)) {
    reader.diagnostics().Fail(reader.Where("axis"), "found axis [0 0 0], expected a direction");
    return;
  }
  const double x = (*axis)[0] / largest;
  const double y = (*axis)[1] / largest;
  const double z = (*axis)[2] / largest;
  const double length = std::sqrt(x * x + y * y + z * z);
  joint.axis_xy = {x / length, y / length};
  joint.axis_z = z / length;
}

void ReadLimits(PropertyReader& reader, JointDescription& joint) {
  const double min = reader.Number("min_position", 0.0);
  const double max = reader.Number("max_position", 1.0);
  if (min > max) {
    const bool max_is_given = reader.entity().Find("max_position") != nullptr;
    reader.diagnostics().Fail(reader.Where(max_is_given ? "max_position" : "min_position"),
                              "found a 'max_position' of " + NumberText(max) + " below the 'min_position' of " +
                                  NumberText(min) + ", expected the other way round");
    return;
  }
  const double start = reader.Number("start_position", std::clamp(0.0, min, max), min, max);
  const auto scaled = [&](double value) {
    return joint.type == JointType::kRevolute ? reader.units().Angle(value) : value * reader.units().length;
  };
  joint.position = {scaled(min), scaled(max)};
  joint.start = scaled(start);
  joint.max_speed = scaled(reader.Number("max_speed", 1.0, 0.0));
}

}  // namespace

JointDescription ReadActuator(PropertyReader& reader) {
  JointDescription joint;
  joint.type = ReadIsRotational(reader) ? JointType::kRevolute : JointType::kPrismatic;
  ReadAxis(reader, joint);
  ReadLimits(reader, joint);
  return joint;
}

void ReadStandingActuator(PropertyReader& reader) {
  reader.diagnostics().Warn(reader.entity().where, "this actuator is on no robot, so it does not move");
  JointDescription joint;
  joint.type = ReadIsRotational(reader) ? JointType::kRevolute : JointType::kPrismatic;
  reader.Use("axis");
  ReadLimits(reader, joint);
}

}  // namespace troupe
