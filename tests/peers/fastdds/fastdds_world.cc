// Calls services of the node /world from Fast DDS, each after discovery of both its endpoints: features, spawn, move,
// state, step, delete. Prints each response as a JSON line and ends after the last one. Loopback only.
//   fastdds_world DOMAIN
#include <cmath>
#include <cstdlib>

#include "service_client.h"
#include "simulationPubSubTypes.h"
#include "simulation_editsPubSubTypes.h"

namespace {

namespace srv = simulation_interfaces::srv::dds_;

json ToJson(const simulation_interfaces::msg::dds_::Result_& result) {
  return {result.result(), result.error_message()};
}
json ToJson(const geometry_msgs::msg::dds_::Vector3_& v) {
  return {v.x(), v.y(), v.z()};
}

geometry_msgs::msg::dds_::Pose_ PoseAt(double x, double y, double heading) {
  geometry_msgs::msg::dds_::Pose_ pose;
  pose.position().x(x);
  pose.position().y(y);
  pose.orientation().z(std::sin(heading / 2.0));
  pose.orientation().w(std::cos(heading / 2.0));
  return pose;
}

class World {
 public:
  explicit World(Peer& peer)
      : features_(peer, "/world/get_simulator_features"),
        spawn_(peer, "/world/spawn_entity"),
        delete_(peer, "/world/delete_entity"),
        set_state_(peer, "/world/set_entity_state"),
        get_state_(peer, "/world/get_entity_state"),
        step_(peer, "/world/step_simulation") {
    features_.WaitForService();
    spawn_.WaitForService();
    delete_.WaitForService();
    set_state_.WaitForService();
    get_state_.WaitForService();
    step_.WaitForService();
  }

  void Features() {
    const auto answer = features_.Call({}).features();
    Print({{"topic", "features"},
           {"features", answer.features()},
           {"formats", answer.spawn_formats()},
           {"info", answer.custom_info()}});
  }
  void Spawn(const std::string& name, const std::string& uri, double x, double y, double heading) {
    srv::SpawnEntity_Request_ request;
    request.name(name);
    request.uri(uri);
    request.entity_namespace("/" + name);
    request.initial_pose().header().frame_id("map");
    request.initial_pose().pose(PoseAt(x, y, heading));
    const auto answer = spawn_.Call(request);
    Print({{"topic", "spawned"}, {"result", ToJson(answer.result())}, {"name", answer.entity_name()}});
  }
  void Delete(const std::string& name) {
    srv::DeleteEntity_Request_ request;
    request.entity(name);
    Print({{"topic", "deleted"}, {"result", ToJson(delete_.Call(request).result())}});
  }
  void Set(const std::string& name, double x, double y, double heading) {
    srv::SetEntityState_Request_ request;
    request.entity(name);
    request.state().header().frame_id("map");
    request.state().pose(PoseAt(x, y, heading));
    Print({{"topic", "set"}, {"result", ToJson(set_state_.Call(request).result())}});
  }
  void Get(const std::string& name) {
    srv::GetEntityState_Request_ request;
    request.entity(name);
    const auto answer = get_state_.Call(request);
    const auto& pose = answer.state().pose();
    Print({{"topic", "state"},
           {"result", ToJson(answer.result())},
           {"stamp", {answer.state().header().stamp().sec(), answer.state().header().stamp().nanosec()}},
           {"frame", answer.state().header().frame_id()},
           {"position", {pose.position().x(), pose.position().y(), pose.position().z()}},
           {"orientation",
            {pose.orientation().x(), pose.orientation().y(), pose.orientation().z(), pose.orientation().w()}},
           {"linear", ToJson(answer.state().twist().linear())},
           {"angular", ToJson(answer.state().twist().angular())},
           {"acceleration",
            {ToJson(answer.state().acceleration().linear()), ToJson(answer.state().acceleration().angular())}}});
  }
  void Step(std::uint64_t steps) {
    srv::StepSimulation_Request_ request;
    request.steps(steps);
    Print({{"topic", "stepped"}, {"result", ToJson(step_.Call(request).result())}});
  }

 private:
  Client<srv::GetSimulatorFeatures_Request_PubSubType, srv::GetSimulatorFeatures_Response_PubSubType> features_;
  Client<srv::SpawnEntity_Request_PubSubType, srv::SpawnEntity_Response_PubSubType> spawn_;
  Client<srv::DeleteEntity_Request_PubSubType, srv::DeleteEntity_Response_PubSubType> delete_;
  Client<srv::SetEntityState_Request_PubSubType, srv::SetEntityState_Response_PubSubType> set_state_;
  Client<srv::GetEntityState_Request_PubSubType, srv::GetEntityState_Response_PubSubType> get_state_;
  Client<srv::StepSimulation_Request_PubSubType, srv::StepSimulation_Response_PubSubType> step_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  Peer peer(static_cast<std::uint32_t>(std::stoul(argv[1])));
  try {
    World world(peer);
    world.Features();
    world.Spawn("late", "rover", 0.5, -2.0, 1.0);
    world.Get("late");
    world.Set("late", 1.0, -2.0, 2.0);
    world.Get("late");
    world.Step(3);
    world.Get("late");
    world.Delete("late");
    world.Get("late");
    peer.Close();
  } catch (const std::exception& exception) {
    Print({{"topic", "failed"}, {"why", exception.what()}});
    std::_Exit(1);
  }
  Print({{"topic", "done"}});
  return 0;
}
