#include "world-service/observers/ros/simulation_context.h"

#include <vector>

#include "common/ros/names.h"

namespace troupe {

SimulationContext::SimulationContext(const std::shared_ptr<const Scene>& scene, WorldControl& control)
    : control_(control) {
  ChangeWorld(scene);
}

void SimulationContext::ChangeWorld(const std::shared_ptr<const Scene>& scene) {
  const WorldDescription& world = scene->world();
  const std::vector<std::string> names = ros::RobotNames(world);
  const std::lock_guard lock(mutex_);
  scene_ = scene;
  ros_names_.clear();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (IsThere(world, RobotId(i))) ros_names_[world.robots[i].name] = names[i];
  }
}

std::shared_ptr<const Scene> SimulationContext::scene() const {
  const std::lock_guard lock(mutex_);
  return scene_;
}

std::string SimulationContext::RosNameOf(const EntityReport& entity) const {
  if (entity.kind != EntityKind::kRobot) return entity.name;
  const std::lock_guard lock(mutex_);
  const auto found = ros_names_.find(entity.name);
  return found == ros_names_.end() ? ros::RosName(entity.name) : found->second;
}

}  // namespace troupe
