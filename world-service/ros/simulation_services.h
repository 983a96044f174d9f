// SimulationServices: the standard services of package simulation_interfaces that Troupe has, and std_srvs/Empty
// /reset: features, state and step here, the others in entity_services.h
// and step_action.h. docs/ros2.md lists them.
#pragma once

#include <memory>
#include <string>

#include "common/ros/ros_options.h"
#include "common/ros_dds/ros_participant.h"
#include "common/spatial/scene.h"
#include "world-service/ros/entity_services.h"
#include "world-service/ros/step_action.h"
#include "world-service/service/world_control.h"

namespace troupe {

class SimulationServices {
 public:
  // The control must outlive it. `name`: the node's, in the service names.
  SimulationServices(const ros::RosNode& node, const std::string& name, const ros::RosOptions& options,
                     const std::shared_ptr<const Scene>& scene, WorldControl& control);
  ~SimulationServices();  // no call of the control runs any more when it returns; open requests are forgotten

  // The world is another one, after an edit.
  void ChangeWorld(const std::shared_ptr<const Scene>& scene);
  // What the run has come to.
  void Publish(const FrameMessage& frame) { step_action_.Publish(frame); }

 private:
  class Services;
  std::shared_ptr<SimulationContext> context_;
  std::shared_ptr<Services> services_;  // shared with requests that wait for their answer
  EntityServices entities_;
  StepAction step_action_;
};

}  // namespace troupe
