#include "robot-agent/navigation/rays.h"

#include <utility>

#include "common/base/intern.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

// Null for a sensor of another kind.
const RangerParameters* RangerOf(const SensorInfo& sensor) {
  return std::get_if<RangerParameters>(&sensor.description->parameters);
}

// In the robot's frame; the indices are places in the ranges of a reading.
std::vector<PlacedRay> ListRays(const SensorInfo& sensor) {
  std::vector<PlacedRay> rays;
  std::size_t place = 0;
  for (const RaySensorDescription& ray_sensor : *RangerOf(sensor)->ray_sensors) {
    const ScanGeometry scan{.fan = {ray_sensor.fov, ray_sensor.samples}, .elevations = ray_sensor.elevations};
    const Pose X_RS = sensor.X_RM * ray_sensor.X_MS;
    // Of several planes, the one that is nearest to the horizontal counts.
    const std::size_t first = place + FlattestPlane(scan) * scan.fan.count;
    for (std::size_t i = 0; i < scan.fan.count; ++i) {
      const double bearing = WrapAngle(sensor.X_RM.heading + ray_sensor.X_MS.heading + scan.fan.Bearing(i));
      const SinCosResult direction = SinCos(bearing);
      rays.push_back({{bearing, ray_sensor.range.max, first + i}, X_RS.translation(), {direction.cos, direction.sin}});
    }
    place += scan.rays();
  }
  return rays;
}

}  // namespace

// Interned: robots of one model share the list.
Shared<std::vector<RangerRay>> RaysOf(const RobotInfo& info, std::size_t ranger) {
  std::vector<RangerRay> rays;
  for (const PlacedRay& placed : ListRays(info.sensors[ranger])) rays.push_back(placed.ray);
  return Intern(std::move(rays));
}

Shared<std::vector<PlacedRay>> PlacedRaysOf(const RobotInfo& info, std::size_t ranger) {
  return Intern(ListRays(info.sensors[ranger]));
}

// The ranger whose sensor has most rays; a sensor of one ray is no scanner.
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

// A scanner, else a ring of sonars, else any ranger.
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
