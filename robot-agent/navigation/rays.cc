#include "robot-agent/navigation/rays.h"

#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

// Null for a sensor of another kind.
const RangerParameters* RangerOf(const SensorInfo& sensor) {
  return std::get_if<RangerParameters>(&sensor.description->parameters);
}

}  // namespace

std::vector<RangerRay> RaysOf(const RobotInfo& info, std::size_t ranger) {
  const double mount = info.sensors[ranger].X_RM.heading;
  const std::vector<RaySensorDescription>& sensors = RangerOf(info.sensors[ranger])->ray_sensors;
  std::vector<RangerRay> rays;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const RayFan fan{sensors[s].fov, sensors[s].samples};
    RangeScan planes;  // of several, the one that is nearest to the horizontal counts
    planes.elevations = sensors[s].elevations;
    const std::size_t first = FlattestPlane(planes) * fan.count;
    for (std::size_t i = 0; i < fan.count; ++i) {
      rays.push_back({WrapAngle(mount + sensors[s].X_MS.heading + fan.Bearing(i)), sensors[s].range.max, s, first + i});
    }
  }
  return rays;
}

std::vector<PlacedRay> PlacedRaysOf(const RobotInfo& info, std::size_t ranger) {
  const SensorInfo& sensor = info.sensors[ranger];
  const std::vector<RaySensorDescription>& sensors = RangerOf(sensor)->ray_sensors;
  std::vector<PlacedRay> placed;
  for (const RangerRay& ray : RaysOf(info, ranger)) {
    const Pose X_RS = sensor.X_RM * sensors[ray.sensor].X_MS;
    const SinCosResult direction = SinCos(ray.bearing);
    placed.push_back({ray, X_RS.translation(), {direction.cos, direction.sin}});
  }
  return placed;
}

std::optional<std::size_t> FindScanner(const RobotInfo& info) {
  std::optional<std::size_t> found;
  std::uint32_t most = 1;
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    const RangerParameters* const ranger = RangerOf(info.sensors[i]);
    if (ranger == nullptr) continue;
    for (const RaySensorDescription& sensor : *ranger->ray_sensors) {
      if (sensor.samples <= most) continue;
      most = sensor.samples;
      found = i;
    }
  }
  return found;
}

std::optional<std::size_t> FindSonar(const RobotInfo& info) {
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    const RangerParameters* const ranger = RangerOf(info.sensors[i]);
    if (ranger != nullptr && ranger->ray_sensors->size() > 1) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> FindRanger(const RobotInfo& info) {
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (RangerOf(info.sensors[i]) != nullptr) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> FindBestRanger(const RobotInfo& info) {
  std::optional<std::size_t> ranger = FindScanner(info);
  if (!ranger) ranger = FindSonar(info);
  return ranger ? ranger : FindRanger(info);
}

std::optional<std::size_t> FindFinder(const RobotInfo& info) {
  for (std::size_t i = 0; i < info.sensors.size(); ++i) {
    if (std::holds_alternative<FiducialParameters>(info.sensors[i].description->parameters)) return i;
  }
  return std::nullopt;
}

}  // namespace troupe
