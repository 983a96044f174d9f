#include "robot-agent/controller/rays.h"

#include "common/base/deterministic_math.h"

namespace troupe {

std::vector<Ray> RaysOf(const RobotInfo& info, std::size_t ranger) {
  const double mount = ranger < info.X_RM.size() ? info.X_RM[ranger].heading : 0.0;
  const std::vector<RaySensorDescription>& sensors = info.robot->rangers[ranger].sensors;
  std::vector<Ray> rays;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const double last = sensors[s].samples > 1 ? sensors[s].samples - 1 : 1;
    const double first_bearing = sensors[s].samples > 1 ? -0.5 * sensors[s].fov : 0.0;
    for (std::size_t i = 0; i < sensors[s].samples; ++i) {
      const double bearing = first_bearing + sensors[s].fov * (static_cast<double>(i) / last);
      rays.push_back({WrapAngle(mount + sensors[s].X_MS.heading + bearing), sensors[s].range.max, s, i});
    }
  }
  return rays;
}

double RangeOf(const RangerReading& reading, const Ray& ray) {
  if (ray.sensor >= reading.scans.size()) return ray.max_range;
  const std::vector<double>& ranges = reading.scans[ray.sensor].ranges;
  return ray.sample < ranges.size() ? ranges[ray.sample] : ray.max_range;
}

std::optional<std::size_t> FindScanner(const RobotDescription& robot) {
  std::optional<std::size_t> found;
  std::uint32_t most = 1;
  for (std::size_t i = 0; i < robot.rangers.size(); ++i) {
    for (const RaySensorDescription& sensor : robot.rangers[i].sensors) {
      if (sensor.samples <= most) continue;
      most = sensor.samples;
      found = i;
    }
  }
  return found;
}

std::optional<std::size_t> FindSonar(const RobotDescription& robot) {
  for (std::size_t i = 0; i < robot.rangers.size(); ++i) {
    if (robot.rangers[i].sensors.size() > 1) return i;
  }
  return std::nullopt;
}

}  // namespace troupe
