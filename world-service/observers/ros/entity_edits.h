// EntityEdits: the services of package simulation_interfaces that move and delete entities. docs/ros2.md lists
// them.
#pragma once

#include <string>

#include "ros/messages/ros_options.h"
#include "world-service/observers/ros/service_group.h"
#include "world-service/observers/ros/service_slot.h"

namespace troupe {

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

}  // namespace troupe
