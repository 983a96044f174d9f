#include "world-service/core/imu_velocities.h"

#include "common/spatial/point_velocity.h"

namespace troupe {

void KeepVelocities(const Scene& scene, const BodyIndex& bodies, WorldState& state, std::optional<RobotId> robot) {
  for (std::size_t i = 0; i < scene.imus().size(); ++i) {
    const SensorPlace& place = scene.imus()[i];
    if (robot && place.robot != *robot) continue;
    const SensorDescription& sensor = scene.world().robot(place.robot).sensors[place.sensor];
    const Pose& X_MS = std::get<ImuParameters>(sensor.parameters).X_MS;
    const PointVelocity velocity = VelocityOf(scene, bodies, state, sensor.model, X_MS);
    state.imus[i] = {velocity.xy.x(), velocity.xy.y(), velocity.z};
  }
}

void KeepVelocities(const Scene& scene, RobotId robot, WorldState& state) {
  if (state.imus.empty()) return;
  BodyIndex bodies(scene);
  bodies.Assign(state);
  KeepVelocities(scene, bodies, state, robot);
}

}  // namespace troupe
