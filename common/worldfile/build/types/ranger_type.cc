// `ranger`: one or more ray sensors.
#include <algorithm>
#include <cmath>

#include "common/geometry/limits.h"
#include "common/worldfile/build/properties/unused_properties.h"
#include "common/worldfile/build/types/built_in_types.h"
#include "common/worldfile/text/quote.h"

namespace troupe {
namespace {

constexpr double kDefaultSensorHeight = 0.02;  // m

double ReadFov(PropertyReader& reader, double otherwise) {
  const auto fov = reader.Numbers("fov", 1);
  if (!fov) return otherwise;
  const double radians = reader.units().Angle(fov->front());
  // Files in radians round 2 pi up.
  if (radians >= 0.0 && radians <= 2.0 * kPi + 1e-3) return std::min(radians, 2.0 * kPi);
  reader.diagnostics().Fail(reader.Where("fov"), "found " + NumberText(fov->front()) + " for 'fov', expected 0 to " +
                                                     (reader.units().degrees ? "360 degrees" : "6.2832 radians"));
  return otherwise;
}

Interval ReadRange(PropertyReader& reader, const Interval& otherwise) {
  const auto range = reader.Numbers("range", 2);
  if (!range) return otherwise;
  const Interval result{(*range)[0] * reader.units().length, (*range)[1] * reader.units().length};
  if (result.min >= 0.0 && result.max > result.min && result.max <= kMaxMagnitude) return result;
  reader.diagnostics().Fail(reader.Where("range"), "found range [" + NumberText((*range)[0]) + " " +
                                                       NumberText((*range)[1]) +
                                                       "], expected [min max] with 0 <= min < max <= 1000 km");
  return otherwise;
}

struct Noise {
  double variance = 0.0;      // m^2
  double proportional = 0.0;  // of the range
  double angle = 0.0;         // rad
};

Noise ReadNoise(PropertyReader& reader) {
  const auto noise = reader.Numbers("noise", 3);
  if (!noise) return {};
  if (*std::min_element(noise->begin(), noise->end()) < 0.0) {
    reader.diagnostics().Fail(reader.Where("noise"), "found negative noise, expected values of at least 0");
    return {};
  }
  return {(*noise)[0], (*noise)[1], reader.units().Angle((*noise)[2])};
}

RaySensorDescription ReadSensor(const WorldNode& node, const Pose& X_MD, const Units& units, Diagnostics& diagnostics) {
  PropertyReader reader(node, units, diagnostics);
  RaySensorDescription sensor;
  double height = kDefaultSensorHeight;
  if (const auto size = reader.Numbers("size", 3)) height = (*size)[2] * units.length;
  const Pose X_DS = reader.ReadPose("pose").value_or(Pose{});
  sensor.X_MS = X_MD * X_DS;
  sensor.X_MS.z += 0.5 * height;  // rays leave from half the sensor's height
  if (!IsWithinReach(sensor.X_MS)) {
    diagnostics.Fail(reader.Where("pose"), "found a sensor beyond 1000 km, expected it nearer");
  }
  sensor.range = ReadRange(reader, sensor.range);
  sensor.fov = ReadFov(reader, sensor.fov);
  sensor.samples = static_cast<std::uint32_t>(reader.Integer("samples", 1, 1, kMaxRaySamples));
  const Noise noise = ReadNoise(reader);
  sensor.noise_variance = noise.variance;
  sensor.noise_proportional = noise.proportional;
  sensor.noise_angle = noise.angle;
  WarnOfUnusedInSensor(reader);
  if (!node.children.empty()) {
    diagnostics.Fail(node.children.front().where,
                     "found " + Quoted(node.children.front().type) + " inside a sensor, expected only properties");
  }
  return sensor;
}

// The ranger of `reader`, without its name and model.
SensorDescription ReadRanger(PropertyReader& reader, const Pose& X_MD, std::int64_t interval_ns) {
  SensorDescription description;
  RangerParameters ranger;
  const double period_ns = reader.Number("update_interval", 100.0, 0.0, 1e9) * 1e6;
  const double ticks = std::ceil(period_ns / static_cast<double>(interval_ns));
  description.period_ticks = static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 4e9));
  for (const WorldNode& child : reader.node().children) {
    if (child.type == "sensor") {
      ranger.ray_sensors.push_back(ReadSensor(child, X_MD, reader.units(), reader.diagnostics()));
    }
  }
  if (ranger.ray_sensors.empty()) {
    reader.diagnostics().Warn(reader.node().where, "this ranger has no 'sensor', so it measures nothing");
  }
  description.parameters = std::move(ranger);
  return description;
}

class RangerReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    SensorDescription ranger = ReadRanger(reader, draft.X_MD, context.world.interval_ns);
    if (!draft.robot) {
      reader.diagnostics().Warn(draft.node.where, "this ranger is on no robot, so it measures nothing");
      return;
    }
    ranger.name = NameOnRobot(context.world, *draft.robot, draft.model.name);
    ranger.model = draft.id;
    context.world.robots[draft.robot->index()].sensors.push_back(std::move(ranger));
  }
};

}  // namespace

ModelType RangerType() {
  return {.name = "ranger",
          .has_body = false,
          .size = {0.15, 0.15, 0.2},
          .color = {0.0, 0.0, 139.0 / 255.0, 1.0},
          .has_sensors = true,
          .make_reader = MakeReader<RangerReader>};
}

}  // namespace troupe
