// The services of package simulation_interfaces that change entities. docs/ros2.md lists them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ros/messages/ros_options.h"
#include "world-service/observers/ros/service_group.h"

namespace troupe {

// Those that move and delete entities.
class EntityEdits : public ServiceGroup<EntityEdits> {
 public:
  explicit EntityEdits(std::shared_ptr<SimulationContext> context) : ServiceGroup(std::move(context)) {}

  // `prefix`: of the services' names, with a slash at its end.
  void Open(const ros::RosNode& node, const std::string& prefix, ros::Distribution distribution);
  // No service answers after it returns.
  void Close();

 private:
  void OnSetState(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__SetEntityState_Request_& request);
  void OnSetRollingState(const ros::RosCaller& caller,
                         const rolling_simulation_interfaces_srv_dds__SetEntityState_Request_& request);
  void OnDelete(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__DeleteEntity_Request_& request);

  // Of a state, that a request sets.
  struct Parts {
    bool pose = false;
    bool twist = false;
    bool acceleration = false;
  };
  template <typename Slot>
  void SetState(const ros::RosCaller& caller, const char* entity_name,
                const simulation_interfaces_msg_dds__EntityState_& state, const Parts& parts, Slot& slot);
  void AnswerDelete(const ros::RosCaller& caller, ResultCode code, const std::string& problem);

  ServiceSlot<simulation_interfaces_srv_dds__DeleteEntity_Request_,
              simulation_interfaces_srv_dds__DeleteEntity_Response_>
      delete_;
  // One of these two is open, by distribution.
  ServiceSlot<simulation_interfaces_srv_dds__SetEntityState_Request_,
              simulation_interfaces_srv_dds__SetEntityState_Response_>
      set_state_;
  ServiceSlot<rolling_simulation_interfaces_srv_dds__SetEntityState_Request_,
              simulation_interfaces_srv_dds__SetEntityState_Response_>
      set_rolling_state_;
};

// Those that spawn entities, one or several.
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
