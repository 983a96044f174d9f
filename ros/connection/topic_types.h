// Registers the ROS types of topics with the DDS binding.
#pragma once

#include "idl/ros/actions.h"
#include "idl/ros/discovery.h"
#include "idl/ros/node.h"
#include "idl/ros/parameters.h"
#include "idl/ros/simulation.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/topic.h"

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
#define TROUPE_HUMBLE_DDS_TYPE(type, name_on_dds)        \
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
TROUPE_HUMBLE_DDS_TYPE(humble_sensor_msgs_msg_dds__Range_, "sensor_msgs::msg::dds_::Range_");
TROUPE_HUMBLE_DDS_TYPE(humble_rmw_dds_common_msg_dds__ParticipantEntitiesInfo_,
                       "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
