// The services about the whole world. docs/ros2.md lists them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "world-service/observers/ros/service_group.h"

namespace troupe {

// The services of package simulation_interfaces that load and reset the world, and std_srvs/Empty /reset.
class WorldServices : public ServiceGroup<WorldServices> {
 public:
  explicit WorldServices(std::shared_ptr<SimulationContext> context) : ServiceGroup(std::move(context)) {}

  // `prefix`: of the services' names, with a slash at its end.
  void Open(const ros::RosNode& node, const std::string& prefix);
  // No service answers after it returns.
  void Close();

 private:
  void OnLoad(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__LoadWorld_Request_& request);
  void OnUnload(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__UnloadWorld_Request_& request);
  void OnReset(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__ResetSimulation_Request_& request);
  void OnPlainReset(const ros::RosCaller& caller, const std_srvs_srv_dds__Empty_Request_& request);

  void AnswerLoad(const ros::RosCaller& caller, std::uint8_t code, const std::string& problem, const std::string& world,
                  const std::string& path);

  ServiceSlot<simulation_interfaces_srv_dds__LoadWorld_Request_, simulation_interfaces_srv_dds__LoadWorld_Response_>
      load_;
  ServiceSlot<simulation_interfaces_srv_dds__UnloadWorld_Request_, simulation_interfaces_srv_dds__UnloadWorld_Response_>
      unload_;
  ServiceSlot<simulation_interfaces_srv_dds__ResetSimulation_Request_,
              simulation_interfaces_srv_dds__ResetSimulation_Response_>
      reset_;
  ServiceSlot<std_srvs_srv_dds__Empty_Request_, std_srvs_srv_dds__Empty_Response_> plain_reset_;
};

// The services of package simulation_interfaces that report the loaded world, its named poses and the worlds that can
// be loaded.
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
