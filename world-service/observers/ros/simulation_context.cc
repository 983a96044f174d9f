#include "world-service/observers/ros/simulation_context.h"

#include <algorithm>

#include "ros/messages/names.h"
#include "world-service/observers/ros/request_values.h"

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
  std::erase_if(infos_, [&](const auto& info) {
    return std::none_of(world.models.begin(), world.models.end(),
                        [&](const ModelDescription& model) { return !model.removed && model.name == info.first; });
  });
  ros_names_.clear();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (RobotExists(world, RobotId(i))) ros_names_[world.robots[i].name] = names[i];
  }
}

EntityInfo SimulationContext::InfoOf(const EntityReport& entity) const {
  const std::lock_guard lock(mutex_);
  const auto found = infos_.find(entity.name);
  return found != infos_.end() ? found->second : EntityInfo{CategoryOf(entity.kind), entity.type, {}};
}

void SimulationContext::SetInfo(const EntityReport& entity, EntityInfo info) {
  const std::lock_guard lock(mutex_);
  infos_[entity.name] = std::move(info);
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
