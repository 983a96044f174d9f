// SimulationServices: the standard services of package simulation_interfaces that Troupe has: features, state, step,
// entities and their states. docs/ros2.md lists them.
#pragma once

#include <memory>

#include "common/ros_dds/ros_participant.h"
#include "common/spatial/scene.h"
#include "world-service/service/world_control.h"

namespace troupe {

class SimulationServices {
 public:
  // Scene and control must outlive it. `name`: the node's, in the service names.
  SimulationServices(const ros::RosNode& node, const std::string& name, const Scene& scene, WorldControl& control);
  ~SimulationServices();  // no call of the control runs any more when it returns; open requests are forgotten

 private:
  class Services;
  std::shared_ptr<Services> services_;  // shared with requests that wait for their answer
};

}  // namespace troupe
