// WorldQueries: the services of package simulation_interfaces that report the loaded world, its named poses and the
// worlds that can be loaded.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "world-service/observers/ros/service_group.h"
#include "world-service/observers/ros/service_slot.h"

namespace troupe {

class WorldQueries : public ServiceGroup<WorldQueries> {
 public:
  explicit WorldQueries(std::shared_ptr<SimulationContext> context) : ServiceGroup(std::move(context)) {}

  // `prefix`: of the services' names, with a slash at its end.
  void Open(const ros::RosNode& node, const std::string& prefix);
  // No service answers after it returns.
  void Close();

 private:
  struct Search;

  void OnGetWorld(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__GetCurrentWorld_Request_& request);
  void OnGetWorlds(const ros::RosCaller& caller,
                   const simulation_interfaces_srv_dds__GetAvailableWorlds_Request_& request);
  void OnGetPoses(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__GetNamedPoses_Request_& request);
  // In the sources from the next one on, one after another.
  void SearchNext(const std::shared_ptr<Search>& search);
  void Answer(const Search& search, ResultCode code, const std::string& problem);

  ServiceSlot<simulation_interfaces_srv_dds__GetCurrentWorld_Request_,
              simulation_interfaces_srv_dds__GetCurrentWorld_Response_>
      get_world_;
  ServiceSlot<simulation_interfaces_srv_dds__GetAvailableWorlds_Request_,
              simulation_interfaces_srv_dds__GetAvailableWorlds_Response_>
      get_worlds_;
  ServiceSlot<simulation_interfaces_srv_dds__GetNamedPoses_Request_,
              simulation_interfaces_srv_dds__GetNamedPoses_Response_>
      get_poses_;
};

}  // namespace troupe
