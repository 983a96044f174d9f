// EntityServices: the standard services of package simulation_interfaces about what is in the world: entities and their
// states, spawning, deleting, moving; loading a world, and reset. docs/ros2.md lists them.
#pragma once

#include <memory>
#include <string>

#include "common/ros/ros_options.h"
#include "common/ros_dds/ros_participant.h"

namespace troupe {

class SimulationContext;

class EntityServices {
 public:
  // `name`: the node's, in the service names.
  EntityServices(const ros::RosNode& node, const std::string& name, ros::Distribution distribution,
                 std::shared_ptr<const SimulationContext> context);
  ~EntityServices();  // no service answers any more when it returns; open requests are forgotten

 private:
  class Services;
  std::shared_ptr<Services> services_;  // shared with requests that wait for their answer
};

}  // namespace troupe
