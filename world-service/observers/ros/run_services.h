// RunServices: the services of package simulation_interfaces that report the simulator's features and that report and
// change the state of the run. docs/ros2.md lists them.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "world-service/observers/ros/service_group.h"

namespace troupe {

class RunServices : public ServiceGroup<RunServices> {
 public:
  explicit RunServices(std::shared_ptr<SimulationContext> context) : ServiceGroup(std::move(context)) {}

  // `prefix`: of the services' names, with a slash at its end.
  void Open(const ros::RosNode& node, const std::string& prefix);
  // No service answers after it returns.
  void Close();

 private:
  void OnGetFeatures(const ros::RosCaller& caller,
                     const simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_& request);
  void OnGetState(const ros::RosCaller& caller,
                  const simulation_interfaces_srv_dds__GetSimulationState_Request_& request);
  void OnSetState(const ros::RosCaller& caller,
                  const simulation_interfaces_srv_dds__SetSimulationState_Request_& request);
  void OnStep(const ros::RosCaller& caller, const simulation_interfaces_srv_dds__StepSimulation_Request_& request);

  void Stop(const ros::RosCaller& caller);
  void AnswerSetState(const ros::RosCaller& caller, std::uint8_t code, const std::string& problem);
  void AnswerSetState(const ros::RosCaller& caller, const ControlReply& reply);
  std::uint8_t StateOf(const ControlReply& reply) const;

  std::atomic<std::optional<Edition>> stopped_edition_ = {};  // of the world after the last stop
  ServiceSlot<simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_,
              simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_>
      get_features_;
  ServiceSlot<simulation_interfaces_srv_dds__GetSimulationState_Request_,
              simulation_interfaces_srv_dds__GetSimulationState_Response_>
      get_state_;
  ServiceSlot<simulation_interfaces_srv_dds__SetSimulationState_Request_,
              simulation_interfaces_srv_dds__SetSimulationState_Response_>
      set_state_;
  ServiceSlot<simulation_interfaces_srv_dds__StepSimulation_Request_,
              simulation_interfaces_srv_dds__StepSimulation_Response_>
      step_;
};

}  // namespace troupe
