// EntityQueries: the services of package simulation_interfaces that report entities, their states and the models that
// can be spawned. docs/ros2.md lists them.
#pragma once

#include <string>
#include <vector>

#include "ros/messages/ros_options.h"
#include "world-service/observers/ros/service_group.h"

namespace troupe {

class EntityQueries : public ServiceGroup<EntityQueries> {
 public:
  explicit EntityQueries(std::shared_ptr<SimulationContext> context) : ServiceGroup(std::move(context)) {}

  // `prefix`: of the services' names, with a slash at its end.
  void Open(const ros::RosNode& node, const std::string& prefix, ros::Distribution distribution);
  // No service answers after it returns.
  void Close();

 private:
  void OnGetEntities(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__GetEntities_Request_& request);
  void OnGetStates(const ros::RosCaller& caller,
                   const simulation_interfaces_srv_dds__GetEntitiesStates_Request_& request);
  void OnGetState(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__GetEntityState_Request_& request);
  void OnGetInfo(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__GetEntityInfo_Request_& request);
  void OnGetBounds(const ros::RosCaller& caller,
                   const simulation_interfaces_srv_dds__GetEntityBounds_Request_& request);
  void OnSetInfo(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__SetEntityInfo_Request_& request);
  void OnGetSpawnables(const ros::RosCaller& caller,
                       const simulation_interfaces_srv_dds__GetSpawnables_Request_& request);
  void OnGetRollingSpawnables(const ros::RosCaller& caller,
                              const simulation_interfaces_srv_dds__GetSpawnables_Request_& request);

  template <typename Response, typename Slot, typename Add>
  void AnswerMatching(const ros::RosCaller& caller, const simulation_interfaces_msg_dds__EntityFilters_& filters,
                      Slot& slot, Add add);
  template <typename Response, typename Slot, typename UriOf>
  void AnswerSpawnables(const ros::RosCaller& caller, Slot& slot, UriOf uri_of);
  simulation_interfaces_msg_dds__EntityState_ StateOf(const EntityReport& entity, Tick tick,
                                                      dds::WireArena& arena) const;

  ServiceSlot<simulation_interfaces_srv_dds__GetEntities_Request_, simulation_interfaces_srv_dds__GetEntities_Response_>
      get_entities_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntitiesStates_Request_,
              simulation_interfaces_srv_dds__GetEntitiesStates_Response_>
      get_states_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntityState_Request_,
              simulation_interfaces_srv_dds__GetEntityState_Response_>
      get_state_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntityInfo_Request_,
              simulation_interfaces_srv_dds__GetEntityInfo_Response_>
      get_info_;
  ServiceSlot<simulation_interfaces_srv_dds__GetEntityBounds_Request_,
              simulation_interfaces_srv_dds__GetEntityBounds_Response_>
      get_bounds_;
  ServiceSlot<simulation_interfaces_srv_dds__SetEntityInfo_Request_,
              simulation_interfaces_srv_dds__SetEntityInfo_Response_>
      set_info_;
  // One of these two is open, by distribution.
  ServiceSlot<simulation_interfaces_srv_dds__GetSpawnables_Request_,
              simulation_interfaces_srv_dds__GetSpawnables_Response_>
      get_spawnables_;
  ServiceSlot<simulation_interfaces_srv_dds__GetSpawnables_Request_,
              rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_>
      get_rolling_spawnables_;
};

}  // namespace troupe
