#include "worldfile/models/types/sensor_properties.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/limits.h"
#include "worldfile/text/quote.h"

namespace troupe {

std::string AngleText(const Units& units, double radians) {
  return units.degrees ? NumberText(RadiansToDegrees(radians)) + " degrees" : NumberText(radians) + " radians";
}

std::uint32_t ImageSide(PropertyReader& reader, const std::string& name, double found) {
  const double side = std::clamp(found, 1.0, static_cast<double>(kMaxImageSide));
  if (side != found) {
    reader.WarnOfValue(*reader.Use(name), NumberText(found) + " pixels", "1 to " + std::to_string(kMaxImageSide),
                       NumberText(side));
  }
  return static_cast<std::uint32_t>(side);
}

std::uint32_t ReadPeriod(PropertyReader& reader, std::int64_t interval_ns) {
  const double period_ns = reader.Number("update_interval", 100.0, 0.0, 1e9) * 1e6;
  const double ticks = std::ceil(period_ns / static_cast<double>(interval_ns));
  return static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 4e9));
}

double ReadFov(PropertyReader& reader, double otherwise) {
  const auto fov = reader.Numbers("fov", 1);
  if (!fov) return otherwise;
  const double radians = reader.units().Angle(fov->front());
  // Files in radians round 2 pi up.
  if (radians >= 0.0 && radians <= 2.0 * kPi + 1e-3) return std::min(radians, 2.0 * kPi);
  const double used = std::min(std::fabs(radians), 2.0 * kPi);
  reader.WarnOfValue(*reader.Use("fov"), NumberText(fov->front()),
                     std::string("0 to ") + (reader.units().degrees ? "360 degrees" : "6.2832 radians"),
                     AngleText(reader.units(), used));
  return used;
}

Interval ReadRange(PropertyReader& reader, const Interval& otherwise) {
  const auto range = reader.Numbers("range", 2);
  if (!range) return otherwise;
  const Interval found{(*range)[0] * reader.units().length, (*range)[1] * reader.units().length};
  Interval result{std::clamp(found.min, 0.0, kMaxMagnitude), std::clamp(found.max, 0.0, kMaxMagnitude)};
  if (result.min > result.max) std::swap(result.min, result.max);
  if (result.max == 0.0) result = otherwise;
  if (result.min == result.max) result.min = 0.0;
  if (result == found) return result;
  const auto text = [](double min, double max) { return "[" + NumberText(min) + " " + NumberText(max) + "]"; };
  const double unit = reader.units().length;
  reader.diagnostics().Warn(reader.Where("range"), "found range " + text((*range)[0], (*range)[1]) +
                                                       ", expected [min max] with 0 <= min < max <= 1000 km; " +
                                                       text(result.min / unit, result.max / unit) + " is used");
  return result;
}

double ReadDistance(PropertyReader& reader, const std::string& name, double otherwise) {
  const double distance = reader.Length(name, otherwise);
  if (distance >= 0.0) return distance;
  reader.diagnostics().Warn(reader.Where(name),
                            "found a negative " + Quoted(name) + ", expected at least 0; 0 is used");
  return 0.0;
}

double ReadAngle(PropertyReader& reader, const std::string& name, double otherwise, double max) {
  const auto angle = reader.Numbers(name, 1);
  if (!angle) return otherwise;
  const double radians = reader.units().Angle(angle->front());
  if (std::abs(radians) <= max) return radians;
  const double nearest = std::copysign(max, radians);
  reader.WarnOfValue(*reader.Use(name), NumberText(angle->front()),
                     "at most " + AngleText(reader.units(), max) + " to both sides",
                     AngleText(reader.units(), nearest));
  return nearest;
}

void AddSensor(PropertyReader& reader, const ModelDraft& draft, std::string_view noun, SensorParameters parameters,
               BuildContext& context) {
  SensorDescription sensor;
  sensor.period_ticks = ReadPeriod(reader, context.world.interval_ns);
  if (!draft.robot) {
    reader.diagnostics().Warn(draft.node.where,
                              "this " + std::string(noun) + " is on no robot, so it measures nothing");
    return;
  }
  if (const Status problem = CheckParameters(parameters); !problem.ok() && !reader.diagnostics().failed()) {
    reader.diagnostics().Fail(draft.node.where, "found a " + std::string(noun) + " that cannot be: " +
                                                    problem.error().message + ", expected usable values");
  }
  sensor.parameters = std::move(parameters);
  sensor.name = NameOnRobot(context.world, *draft.robot, draft.model.name);
  sensor.model = draft.id;
  context.world.robots[draft.robot->index()].sensors.push_back(std::move(sensor));
}

}  // namespace troupe
