// The ROS types of topics, services and actions for the DDS binding, and a type by its name: the one list of all types
// that this program can read and write. ros-participant finds types here by the names in an agent's messages, so that
// an agent cannot ask it for anything else.
#pragma once

#include <dds/dds.h>

#include <string>

#include "idl/ros/actions.h"
#include "idl/ros/building_map.h"
#include "idl/ros/discovery.h"
#include "idl/ros/kilted.h"
#include "idl/ros/node.h"
#include "idl/ros/parameters.h"
#include "idl/ros/people.h"
#include "idl/ros/rmf.h"
#include "idl/ros/rolling.h"
#include "idl/ros/simulate_steps.h"
#include "idl/ros/simulation.h"
#include "idl/ros/simulation_edits.h"
#include "ros/messages/messages.h"
#include "ros/messages/ros_options.h"
#include "transport/dds/binding/domain_participant.h"

// All types, each as TYPE(name).
#define TROUPE_ROS_TYPES(TYPE)                                            \
  TYPE(action_msgs_msg_dds__GoalStatusArray_)                             \
  TYPE(action_msgs_srv_dds__CancelGoal_Request_)                          \
  TYPE(action_msgs_srv_dds__CancelGoal_Response_)                         \
  TYPE(control_msgs_action_dds__GripperCommand_FeedbackMessage_)          \
  TYPE(control_msgs_action_dds__GripperCommand_GetResult_Request_)        \
  TYPE(control_msgs_action_dds__GripperCommand_GetResult_Response_)       \
  TYPE(control_msgs_action_dds__GripperCommand_SendGoal_Request_)         \
  TYPE(control_msgs_action_dds__GripperCommand_SendGoal_Response_)        \
  TYPE(geometry_msgs_msg_dds__PoseStamped_)                               \
  TYPE(geometry_msgs_msg_dds__PoseWithCovarianceStamped_)                 \
  TYPE(geometry_msgs_msg_dds__Twist_)                                     \
  TYPE(geometry_msgs_msg_dds__TwistStamped_)                              \
  TYPE(nav_msgs_msg_dds__OccupancyGrid_)                                  \
  TYPE(nav_msgs_msg_dds__Odometry_)                                       \
  TYPE(people_msgs_msg_dds__People_)                                      \
  TYPE(rcl_interfaces_msg_dds__Log_)                                      \
  TYPE(rcl_interfaces_msg_dds__ParameterEvent_)                           \
  TYPE(rcl_interfaces_srv_dds__DescribeParameters_Request_)               \
  TYPE(rcl_interfaces_srv_dds__DescribeParameters_Response_)              \
  TYPE(rcl_interfaces_srv_dds__GetParameterTypes_Request_)                \
  TYPE(rcl_interfaces_srv_dds__GetParameterTypes_Response_)               \
  TYPE(rcl_interfaces_srv_dds__GetParameters_Request_)                    \
  TYPE(rcl_interfaces_srv_dds__GetParameters_Response_)                   \
  TYPE(rcl_interfaces_srv_dds__ListParameters_Request_)                   \
  TYPE(rcl_interfaces_srv_dds__ListParameters_Response_)                  \
  TYPE(rcl_interfaces_srv_dds__SetParametersAtomically_Request_)          \
  TYPE(rcl_interfaces_srv_dds__SetParametersAtomically_Response_)         \
  TYPE(rcl_interfaces_srv_dds__SetParameters_Request_)                    \
  TYPE(rcl_interfaces_srv_dds__SetParameters_Response_)                   \
  TYPE(rmf_building_map_msgs_msg_dds__BuildingMap_)                       \
  TYPE(rmf_building_map_msgs_srv_dds__GetBuildingMap_Request_)            \
  TYPE(rmf_building_map_msgs_srv_dds__GetBuildingMap_Response_)           \
  TYPE(rmf_dispenser_msgs_msg_dds__DispenserRequest_)                     \
  TYPE(rmf_dispenser_msgs_msg_dds__DispenserResult_)                      \
  TYPE(rmf_dispenser_msgs_msg_dds__DispenserState_)                       \
  TYPE(rmf_door_msgs_msg_dds__DoorRequest_)                               \
  TYPE(rmf_door_msgs_msg_dds__DoorState_)                                 \
  TYPE(rmf_fleet_msgs_msg_dds__FleetState_)                               \
  TYPE(rmf_fleet_msgs_msg_dds__ModeRequest_)                              \
  TYPE(rmf_fleet_msgs_msg_dds__PathRequest_)                              \
  TYPE(rmf_fleet_msgs_msg_dds__PauseRequest_)                             \
  TYPE(rmf_fleet_msgs_msg_dds__RobotState_)                               \
  TYPE(rmf_ingestor_msgs_msg_dds__IngestorRequest_)                       \
  TYPE(rmf_ingestor_msgs_msg_dds__IngestorResult_)                        \
  TYPE(rmf_ingestor_msgs_msg_dds__IngestorState_)                         \
  TYPE(rmf_lift_msgs_msg_dds__LiftRequest_)                               \
  TYPE(rmf_lift_msgs_msg_dds__LiftState_)                                 \
  TYPE(rmw_dds_common_msg_dds__ParticipantEntitiesInfo_)                  \
  TYPE(rosgraph_msgs_msg_dds__Clock_)                                     \
  TYPE(sensor_msgs_msg_dds__CameraInfo_)                                  \
  TYPE(sensor_msgs_msg_dds__Image_)                                       \
  TYPE(sensor_msgs_msg_dds__Imu_)                                         \
  TYPE(sensor_msgs_msg_dds__JointState_)                                  \
  TYPE(sensor_msgs_msg_dds__BatteryState_)                                \
  TYPE(sensor_msgs_msg_dds__LaserScan_)                                   \
  TYPE(sensor_msgs_msg_dds__PointCloud2_)                                 \
  TYPE(sensor_msgs_msg_dds__Range_)                                       \
  TYPE(simulation_interfaces_srv_dds__GetEntities_Request_)               \
  TYPE(simulation_interfaces_srv_dds__GetEntities_Response_)              \
  TYPE(simulation_interfaces_srv_dds__GetEntityState_Request_)            \
  TYPE(simulation_interfaces_srv_dds__GetEntityState_Response_)           \
  TYPE(simulation_interfaces_srv_dds__GetSimulationState_Request_)        \
  TYPE(simulation_interfaces_srv_dds__GetSimulationState_Response_)       \
  TYPE(simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_)      \
  TYPE(simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_)     \
  TYPE(simulation_interfaces_srv_dds__SetSimulationState_Request_)        \
  TYPE(simulation_interfaces_srv_dds__SetSimulationState_Response_)       \
  TYPE(simulation_interfaces_srv_dds__StepSimulation_Request_)            \
  TYPE(simulation_interfaces_srv_dds__StepSimulation_Response_)           \
  TYPE(std_msgs_msg_dds__Bool_)                                           \
  TYPE(std_msgs_msg_dds__Float64_)                                        \
  TYPE(std_msgs_msg_dds__Header_)                                         \
  TYPE(std_msgs_msg_dds__String_)                                         \
  TYPE(tf2_msgs_msg_dds__TFMessage_)                                      \
  TYPE(type_description_interfaces_srv_dds__GetTypeDescription_Request_)  \
  TYPE(type_description_interfaces_srv_dds__GetTypeDescription_Response_) \
  TYPE(vision_msgs_msg_dds__Detection2DArray_)                            \
  TYPE(vision_msgs_msg_dds__Detection3DArray_)                            \
  TYPE(visualization_msgs_msg_dds__MarkerArray_)

#define TROUPE_ROS_TYPE(type) TROUPE_DDS_TYPE(type);
TROUPE_ROS_TYPES(TROUPE_ROS_TYPE)
#undef TROUPE_ROS_TYPE

// Types of Humble with another layout under the same DDS name.
#define TROUPE_RENAMED_DDS_TYPE(type, name_on_dds)       \
  template <>                                            \
  struct troupe::dds::TopicTraits<type> {                \
    static const dds_topic_descriptor_t* descriptor() {  \
      static const dds_topic_descriptor_t renamed = [] { \
        dds_topic_descriptor_t copy = type##_desc;       \
        copy.m_typename = name_on_dds;                   \
        return copy;                                     \
      }();                                               \
      return &renamed;                                   \
    }                                                    \
  }
TROUPE_RENAMED_DDS_TYPE(humble_sensor_msgs_msg_dds__Range_, "sensor_msgs::msg::dds_::Range_");
TROUPE_RENAMED_DDS_TYPE(humble_rmw_dds_common_msg_dds__ParticipantEntitiesInfo_,
                        "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");

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
TROUPE_RENAMED_DDS_TYPE(rolling_simulation_interfaces_srv_dds__SetEntityState_Request_,
                        "simulation_interfaces::srv::dds_::SetEntityState_Request_");
TROUPE_RENAMED_DDS_TYPE(rolling_simulation_interfaces_srv_dds__GetSpawnables_Response_,
                        "simulation_interfaces::srv::dds_::GetSpawnables_Response_");

// Types of Kilted and later with another layout under the same DDS name.
TROUPE_RENAMED_DDS_TYPE(kilted_rmf_fleet_msgs_msg_dds__FleetState_, "rmf_fleet_msgs::msg::dds_::FleetState_");
TROUPE_RENAMED_DDS_TYPE(kilted_rmf_fleet_msgs_msg_dds__ModeRequest_, "rmf_fleet_msgs::msg::dds_::ModeRequest_");
TROUPE_RENAMED_DDS_TYPE(kilted_rmf_fleet_msgs_msg_dds__RobotState_, "rmf_fleet_msgs::msg::dds_::RobotState_");

namespace troupe::ros {

// The types of topics by their names.
// A type of this file by its name on DDS ("nav_msgs::msg::dds_::Odometry_"), in the layout of
// the distribution; null: there is none.
const dds_topic_descriptor_t* FindTopicType(const std::string& name, Distribution distribution);

// Whether messages of a type of this file begin with a std_msgs/Header, and so with the time of what they tell.
bool BeginsWithHeader(const dds_topic_descriptor_t& type);

}  // namespace troupe::ros
