// SimulationServices: the services and the action of package simulation_interfaces, and std_srvs/Empty /reset, all over
// the control of one run. docs/ros2.md lists them.
#pragma once

#include <memory>
#include <string>

#include "common/spatial/scene.h"
#include "world-service/observers/ros/simulation_context.h"
#include "world-service/observers/ros/step_action.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class SimulationServices {
 public:
  // `name`: the node's, in the service names. REQUIRES: the control outlives the services.
  SimulationServices(const ros::RosNode& node, const std::string& name, const std::shared_ptr<const Scene>& scene,
                     WorldControl& control);
  // After it no call into the control runs; open requests are dropped.
  ~SimulationServices() = default;

  // An edit has replaced the world.
  void ChangeWorld(const std::shared_ptr<const Scene>& scene);
  // Reports a committed tick to the action.
  void Publish(const FrameMessage& frame) { step_action_.Publish(frame); }

 private:
  std::shared_ptr<SimulationContext> context_;  // shared with requests that wait for their answer
  ServiceSet services_;
  StepAction step_action_;
};

}  // namespace troupe
