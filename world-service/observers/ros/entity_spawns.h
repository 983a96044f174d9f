// EntitySpawns: the services of package simulation_interfaces that spawn entities, one or several.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "world-service/observers/ros/service_group.h"
#include "world-service/observers/ros/service_slot.h"

namespace troupe {

class EntitySpawns : public ServiceGroup<EntitySpawns> {
 public:
  explicit EntitySpawns(std::shared_ptr<SimulationContext> context) : ServiceGroup(std::move(context)) {}

  // `prefix`: of the services' names, with a slash at its end.
  void Open(const ros::RosNode& node, const std::string& prefix);
  // No service answers after it returns.
  void Close();

 private:
  struct Order {
    std::string name;
    bool rename = false;
    std::string uri;
    std::string text;  // in place of a file
    std::string name_space;
    Result<Pose> pose = Pose{};
  };
  struct Spawned {
    std::uint8_t code = 0;
    std::string problem;
    std::string name;
  };
  using Answer = std::function<void(EntitySpawns& self, const Spawned& spawned)>;
  struct Orders;

  void OnSpawn(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__SpawnEntity_Request_& request);
  void OnSpawnSeveral(const ros::RosCaller& caller,
                      const simulation_interfaces_srv_dds__SpawnEntities_Request_& request);
  void Spawn(const Order& order, const Answer& answer);
  // The orders from the next one on, one after another.
  void SpawnNext(const std::shared_ptr<Orders>& orders);
  // The namespace of a robot called `name`; "" for its name. The error is one that ROS does not allow, or in use.
  Result<std::string> NamespaceOf(const std::string& asked, const std::string& name) const;

  ServiceSlot<simulation_interfaces_srv_dds__SpawnEntity_Request_, simulation_interfaces_srv_dds__SpawnEntity_Response_>
      spawn_;
  ServiceSlot<simulation_interfaces_srv_dds__SpawnEntities_Request_,
              simulation_interfaces_srv_dds__SpawnEntities_Response_>
      spawn_several_;
};

}  // namespace troupe
