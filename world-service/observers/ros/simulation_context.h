// SimulationContext: the state that the simulation services share: the control of the run, its world, and the names of
// the world's entities in ROS. Any thread may call it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// What simulation_interfaces calls the info of an entity. It changes no result.
struct EntityInfo {
  std::uint8_t category = 0;
  std::string description;
  std::vector<std::string> tags;
};

class SimulationContext {
 public:
  // REQUIRES: the control outlives the context and every group of services that uses it.
  SimulationContext(const std::shared_ptr<const Scene>& scene, WorldControl& control);

  void ChangeWorld(const std::shared_ptr<const Scene>& scene);

  WorldControl& control() const { return control_; }
  std::shared_ptr<const Scene> scene() const;
  // False after the world was unloaded, until another one is loaded.
  bool has_world() const { return !scene()->world().models.empty(); }

  // A robot's name in ROS is its namespace; the names of all other entities are those of the world.
  std::string RosNameOf(const EntityReport& entity) const;

  // As SetInfo has set it; otherwise by the kind and type of the entity, without tags.
  EntityInfo InfoOf(const EntityReport& entity) const;
  void SetInfo(const EntityReport& entity, EntityInfo info);

 private:
  WorldControl& control_;
  mutable std::mutex mutex_;  // guards the members below
  std::shared_ptr<const Scene> scene_;
  std::map<std::string, std::string> ros_names_;  // of robots, by their name in the world
  std::map<std::string, EntityInfo> infos_;       // that were set, by the name in the world
};

}  // namespace troupe
