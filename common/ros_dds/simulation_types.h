// Registers the ROS types of the services that edit a world, and of the action that steps it, with the DDS binding.
#pragma once

#include "common/ros_dds/topic_types.h"
#include "idl/ros/rolling.h"
#include "idl/ros/simulate_steps.h"
#include "idl/ros/simulation_edits.h"

TROUPE_DDS_TYPE(simulation_interfaces_action_dds__SimulateSteps_FeedbackMessage_);
TROUPE_DDS_TYPE(simulation_interfaces_action_dds__SimulateSteps_GetResult_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_action_dds__SimulateSteps_GetResult_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_action_dds__SimulateSteps_SendGoal_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__DeleteEntity_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__DeleteEntity_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntitiesStates_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntitiesStates_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntityInfo_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntityInfo_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetSpawnables_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetSpawnables_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__LoadWorld_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__LoadWorld_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__ResetSimulation_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__ResetSimulation_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__SetEntityState_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__SetEntityState_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__SpawnEntity_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__SpawnEntity_Response_);
TROUPE_DDS_TYPE(std_srvs_srv_dds__Empty_Request_);
TROUPE_DDS_TYPE(std_srvs_srv_dds__Empty_Response_);

TROUPE_HUMBLE_DDS_TYPE(rolling_simulation_interfaces_srv_dds__SetEntityState_Request_,
                       "simulation_interfaces::srv::dds_::SetEntityState_Request_");
TROUPE_HUMBLE_DDS_TYPE(rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_,
                       "simulation_interfaces::srv::dds_::GetSpawnables_Response_");
