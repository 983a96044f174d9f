// SimulationContext: the state that the simulation services share: the control of the run, its world, and the names of
// the world's entities in ROS. Any thread may call it.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "common/spatial/scene.h"
#include "world-service/service/world_control.h"

namespace troupe {

class SimulationContext {
 public:
  // REQUIRES: the control outlives the context and every group of services that uses it.
  SimulationContext(const std::shared_ptr<const Scene>& scene, WorldControl& control);

  void ChangeWorld(const std::shared_ptr<const Scene>& scene);

  WorldControl& control() const { return control_; }
  std::shared_ptr<const Scene> scene() const;

  // A robot's name in ROS is its namespace; the names of all other entities are those of the world.
  std::string RosNameOf(const EntityReport& entity) const;

 private:
  WorldControl& control_;
  mutable std::mutex mutex_;  // guards the members below
  std::shared_ptr<const Scene> scene_;
  std::map<std::string, std::string> ros_names_;  // of robots, by their name in the world
};

}  // namespace troupe
