#include "world-service/observers/ros/simulation_services.h"

namespace troupe {

SimulationServices::SimulationServices(const ros::RosNode& node, const std::string& name,
                                       const std::shared_ptr<const Scene>& scene, WorldControl& control)
    : context_(std::make_shared<SimulationContext>(scene, control)),
      services_(node, name + "/", context_),
      step_action_(node, name + "/simulate_steps", context_) {
  AddRunServices(services_);
  AddWorldServices(services_);
  AddEntityQueries(services_);
  AddEntityEdits(services_);
}

void SimulationServices::ChangeWorld(const std::shared_ptr<const Scene>& scene) {
  context_->ChangeWorld(scene);
}

}  // namespace troupe
