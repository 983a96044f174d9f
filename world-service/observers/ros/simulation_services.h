// SimulationServices: the services and the action of package simulation_interfaces, and std_srvs/Empty /reset, all over
// the control of one run. docs/ros2.md lists them.
#pragma once

#include <memory>
#include <string>

#include "common/spatial/scene.h"
#include "ros/connection/ros_participant.h"
#include "world-service/observers/ros/step_action.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class EntityEdits;
class EntityQueries;
class EntitySpawns;
class RunServices;
class SimulationContext;
class WorldQueries;
class WorldServices;

class SimulationServices {
 public:
  // `name`: the node's, in the service names. REQUIRES: the control outlives the services.
  SimulationServices(const ros::RosNode& node, const std::string& name, const std::shared_ptr<const Scene>& scene,
                     WorldControl& control);
  // After it no call into the control runs; open requests are dropped.
  ~SimulationServices();

  // An edit has replaced the world.
  void ChangeWorld(const std::shared_ptr<const Scene>& scene);
  // Reports a committed tick to the action.
  void Publish(const FrameMessage& frame) { step_action_.Publish(frame); }

 private:
  // All are shared with requests that wait for their answer.
  std::shared_ptr<SimulationContext> context_;
  std::shared_ptr<RunServices> run_;
  std::shared_ptr<WorldServices> world_;
  std::shared_ptr<EntityQueries> queries_;
  std::shared_ptr<EntityEdits> edits_;
  std::shared_ptr<EntitySpawns> spawns_;
  std::shared_ptr<WorldQueries> world_queries_;
  StepAction step_action_;
};

}  // namespace troupe
