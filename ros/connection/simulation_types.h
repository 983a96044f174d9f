// Registers the ROS types of the services that edit a world, and of the action that steps it, with the DDS binding.
#pragma once

#include "idl/ros/rolling.h"
#include "idl/ros/simulate_steps.h"
#include "idl/ros/simulation_edits.h"
#include "ros/connection/topic_types.h"

// All types, each as TYPE(name).
#define TROUPE_SIMULATION_TYPES(TYPE)                                       \
  TYPE(simulation_interfaces_action_dds__SimulateSteps_FeedbackMessage_)    \
  TYPE(simulation_interfaces_action_dds__SimulateSteps_GetResult_Request_)  \
  TYPE(simulation_interfaces_action_dds__SimulateSteps_GetResult_Response_) \
  TYPE(simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_)   \
  TYPE(simulation_interfaces_action_dds__SimulateSteps_SendGoal_Response_)  \
  TYPE(simulation_interfaces_srv_dds__DeleteEntity_Request_)                \
  TYPE(simulation_interfaces_srv_dds__DeleteEntity_Response_)               \
  TYPE(simulation_interfaces_srv_dds__GetEntitiesStates_Request_)           \
  TYPE(simulation_interfaces_srv_dds__GetEntitiesStates_Response_)          \
  TYPE(simulation_interfaces_srv_dds__GetEntityInfo_Request_)               \
  TYPE(simulation_interfaces_srv_dds__GetEntityInfo_Response_)              \
  TYPE(simulation_interfaces_srv_dds__GetSpawnables_Request_)               \
  TYPE(simulation_interfaces_srv_dds__GetSpawnables_Response_)              \
  TYPE(simulation_interfaces_srv_dds__LoadWorld_Request_)                   \
  TYPE(simulation_interfaces_srv_dds__LoadWorld_Response_)                  \
  TYPE(simulation_interfaces_srv_dds__ResetSimulation_Request_)             \
  TYPE(simulation_interfaces_srv_dds__ResetSimulation_Response_)            \
  TYPE(simulation_interfaces_srv_dds__SetEntityState_Request_)              \
  TYPE(simulation_interfaces_srv_dds__SetEntityState_Response_)             \
  TYPE(simulation_interfaces_srv_dds__SpawnEntity_Request_)                 \
  TYPE(simulation_interfaces_srv_dds__SpawnEntity_Response_)                \
  TYPE(simulation_interfaces_srv_dds__GetCurrentWorld_Request_)             \
  TYPE(simulation_interfaces_srv_dds__GetCurrentWorld_Response_)            \
  TYPE(simulation_interfaces_srv_dds__GetAvailableWorlds_Request_)          \
  TYPE(simulation_interfaces_srv_dds__GetAvailableWorlds_Response_)         \
  TYPE(simulation_interfaces_srv_dds__UnloadWorld_Request_)                 \
  TYPE(simulation_interfaces_srv_dds__UnloadWorld_Response_)                \
  TYPE(simulation_interfaces_srv_dds__GetEntityBounds_Request_)             \
  TYPE(simulation_interfaces_srv_dds__GetEntityBounds_Response_)            \
  TYPE(simulation_interfaces_srv_dds__GetNamedPoses_Request_)               \
  TYPE(simulation_interfaces_srv_dds__GetNamedPoses_Response_)              \
  TYPE(simulation_interfaces_srv_dds__SetEntityInfo_Request_)               \
  TYPE(simulation_interfaces_srv_dds__SetEntityInfo_Response_)              \
  TYPE(simulation_interfaces_srv_dds__SpawnEntities_Request_)               \
  TYPE(simulation_interfaces_srv_dds__SpawnEntities_Response_)              \
  TYPE(std_srvs_srv_dds__Empty_Request_)                                    \
  TYPE(std_srvs_srv_dds__Empty_Response_)

#define TROUPE_SIMULATION_TYPE(type) TROUPE_DDS_TYPE(type);
TROUPE_SIMULATION_TYPES(TROUPE_SIMULATION_TYPE)
#undef TROUPE_SIMULATION_TYPE

// Types of Rolling with another layout under the same DDS name.
TROUPE_HUMBLE_DDS_TYPE(rolling_simulation_interfaces_srv_dds__SetEntityState_Request_,
                       "simulation_interfaces::srv::dds_::SetEntityState_Request_");
TROUPE_HUMBLE_DDS_TYPE(rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_,
                       "simulation_interfaces::srv::dds_::GetSpawnables_Response_");
