#include "common/worldfile/ranger_reader.h"

#include <algorithm>
#include <cmath>

#include "common/worldfile/property_catalogue.h"
#include "common/worldfile/quote.h"

namespace troupe {
namespace {

constexpr double kMaxRange = 1e6;  // m
constexpr std::int64_t kMaxSamples = 100'000;
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
  if (result.min >= 0.0 && result.max > result.min && result.max <= kMaxRange) return result;
  reader.diagnostics().Fail(reader.Where("range"), "found range [" + NumberText((*range)[0]) + " " +
                                                       NumberText((*range)[1]) +
                                                       "], expected [min max] with 0 <= min < max <= 1000 km");
  return otherwise;
}

void ReadNoise(PropertyReader& reader, RaySensorDescription& sensor) {
  const auto noise = reader.Numbers("noise", 3);
  if (!noise) return;
  if (*std::min_element(noise->begin(), noise->end()) < 0.0) {
    reader.diagnostics().Fail(reader.Where("noise"), "found negative noise, expected values of at least 0");
    return;
  }
  sensor.noise_variance = (*noise)[0];
  sensor.noise_proportional = (*noise)[1];
  sensor.noise_angle = reader.units().Angle((*noise)[2]);
}

RaySensorDescription ReadSensor(const Entity& entity, const Pose& origin, const Units& units,
                                Diagnostics& diagnostics) {
  PropertyReader reader(entity, units, diagnostics);
  RaySensorDescription sensor;
  double height = kDefaultSensorHeight;
  if (const auto size = reader.Numbers("size", 3)) height = (*size)[2] * units.length;
  const Pose pose = reader.ReadPose("pose").value_or(Pose{});
  sensor.X_MS = origin * pose;
  sensor.X_MS.z += 0.5 * height;  // rays leave from half the sensor's height
  if (!IsWithinReach(sensor.X_MS)) {
    diagnostics.Fail(reader.Where("pose"), "found a sensor beyond 1000 km, expected it nearer");
  }
  sensor.range = ReadRange(reader, sensor.range);
  sensor.fov = ReadFov(reader, sensor.fov);
  sensor.samples = static_cast<std::uint32_t>(reader.Integer("samples", 1, 1, kMaxSamples));
  ReadNoise(reader, sensor);
  WarnOfUnused(reader, "sensor");
  if (!entity.children.empty()) {
    diagnostics.Fail(entity.children.front().where,
                     "found " + Quoted(entity.children.front().type) + " inside a sensor, expected only properties");
  }
  return sensor;
}

}  // namespace

RangerDescription ReadRanger(PropertyReader& reader, const Pose& origin, std::int64_t interval_ns) {
  RangerDescription ranger;
  const double period_ns = reader.Number("update_interval", 100.0, 0.0, 1e9) * 1e6;
  const double ticks = std::ceil(period_ns / static_cast<double>(interval_ns));
  ranger.period_ticks = static_cast<std::uint32_t>(std::clamp(ticks, 1.0, 4e9));
  for (const Entity& child : reader.entity().children) {
    if (child.type == "sensor") {
      ranger.sensors.push_back(ReadSensor(child, origin, reader.units(), reader.diagnostics()));
    }
  }
  if (ranger.sensors.empty()) {
    reader.diagnostics().Warn(reader.entity().where, "this ranger has no 'sensor', so it measures nothing");
  }
  return ranger;
}

}  // namespace troupe
