#include "world-service/core/devices.h"

#include <algorithm>

namespace troupe {

void OperateDevices(std::span<const Proposal* const> by_robot, StepWorkspace& workspace) {
  for (std::size_t i = 0; i < by_robot.size(); ++i) {
    const Proposal* const proposal = by_robot[i];
    if (proposal == nullptr) continue;
    const std::size_t first = proposal->lights.empty() ? 0 : workspace.scene.first_light_of(RobotId(i));
    for (const LightOrder& order : proposal->lights) {
      workspace.next.lights[first + order.light].is_switched_on = order.on;
    }
    const std::span<const SensorPlace> cameras = workspace.scene.cameras();
    for (const CameraOrder& order : proposal->cameras) {
      const auto place = std::lower_bound(cameras.begin(), cameras.end(), SensorPlace{RobotId(i), order.sensor});
      workspace.next.cameras[static_cast<std::size_t>(place - cameras.begin())] = {order.pan, order.tilt};
    }
    if (proposal->say.empty()) continue;
    workspace.robot_events.push_back({.tick = workspace.next.tick,
                                      .type = EventType::kSaid,
                                      .robot = RobotId(i),
                                      .other = {},
                                      .detail = proposal->say});
  }
}

}  // namespace troupe
