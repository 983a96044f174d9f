#include "world-service/observers/ros/simulation_services.h"

#include "world-service/observers/ros/entity_edits.h"
#include "world-service/observers/ros/entity_queries.h"
#include "world-service/observers/ros/run_services.h"
#include "world-service/observers/ros/service_group.h"
#include "world-service/observers/ros/world_services.h"

namespace troupe {

SimulationServices::SimulationServices(const ros::RosNode& node, const std::string& name,
                                       const std::shared_ptr<const Scene>& scene, WorldControl& control)
    : context_(std::make_shared<SimulationContext>(scene, control)),
      run_(std::make_shared<RunServices>(context_)),
      world_(std::make_shared<WorldServices>(context_)),
      queries_(std::make_shared<EntityQueries>(context_)),
      edits_(std::make_shared<EntityEdits>(context_)),
      spawns_(std::make_shared<EntitySpawns>(context_)),
      world_queries_(std::make_shared<WorldQueries>(context_)),
      step_action_(node, name + "/simulate_steps", context_) {
  const std::string prefix = name + "/";
  run_->Open(node, prefix);
  world_->Open(node, prefix);
  queries_->Open(node, prefix, node.connection->distribution());
  edits_->Open(node, prefix, node.connection->distribution());
  spawns_->Open(node, prefix);
  world_queries_->Open(node, prefix);
}

SimulationServices::~SimulationServices() {
  run_->Close();
  world_->Close();
  queries_->Close();
  edits_->Close();
  spawns_->Close();
  world_queries_->Close();
}

void SimulationServices::ChangeWorld(const std::shared_ptr<const Scene>& scene) {
  context_->ChangeWorld(scene);
}

}  // namespace troupe
