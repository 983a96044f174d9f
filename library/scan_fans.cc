#include "library/scan_fans.h"

#include <memory>
#include <utility>

#include "common/sensing/sensor_registry.h"

namespace troupe {

std::vector<ScanFan> MeasureFans(const Scene& scene, const BodyIndex& bodies, const WorldState& state) {
  std::vector<ScanFan> fans;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    for (const std::unique_ptr<const Sensor>& sensor : MakeSensors(scene, RobotId(i))) {
      const SensorReading reading = sensor->Measure({scene, bodies, &state}, state.tick);
      const RangerReading* const ranger = reading.ranger();
      if (ranger == nullptr) continue;  // other kinds have no fans
      for (const RangeScan& scan : ranger->scans) {
        const Pose X_WS = bodies.X_WB(scene.body_of(RobotId(i))) * scan.X_RS;
        const std::size_t first = FlattestPlane(scan) * scan.fan.count;
        const auto begin = scan.ranges.begin() + static_cast<std::ptrdiff_t>(first);
        ScanFan fan{
            X_WS, scan.fan.fov, scan.limits.max, {}, {begin, begin + static_cast<std::ptrdiff_t>(scan.fan.count)}};
        for (std::size_t ray = 0; ray < scan.fan.count; ++ray) fan.bearings.push_back(scan.fan.Bearing(ray));
        fans.push_back(std::move(fan));
      }
    }
  }
  return fans;
}

std::vector<Mark> MeasureMarks(const Scene& scene, const BodyIndex& bodies, const WorldState& state) {
  std::vector<Mark> marks;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    if (!IsThere(scene.world(), RobotId(i))) continue;
    for (const std::unique_ptr<const Sensor>& sensor : MakeSensors(scene, RobotId(i))) {
      const SensedWorld world{scene, bodies, &state};
      if (std::holds_alternative<RangerParameters>(sensor->description().parameters)) continue;  // it has fans
      sensor->AddMarks(world, sensor->Measure(world, state.tick), marks);
    }
  }
  return marks;
}

}  // namespace troupe
