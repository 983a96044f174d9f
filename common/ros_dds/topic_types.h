// Registers the ROS types of topics with the DDS binding.
#pragma once

#include "common/dds/binding/topic.h"
#include "common/ros/messages.h"
#include "idl/ros/actions.h"
#include "idl/ros/discovery.h"
#include "idl/ros/node.h"
#include "idl/ros/parameters.h"
#include "idl/ros/simulation.h"

TROUPE_DDS_TYPE(action_msgs_msg_dds__GoalStatusArray_);
TROUPE_DDS_TYPE(action_msgs_srv_dds__CancelGoal_Request_);
TROUPE_DDS_TYPE(action_msgs_srv_dds__CancelGoal_Response_);
TROUPE_DDS_TYPE(control_msgs_action_dds__GripperCommand_FeedbackMessage_);
TROUPE_DDS_TYPE(control_msgs_action_dds__GripperCommand_GetResult_Request_);
TROUPE_DDS_TYPE(control_msgs_action_dds__GripperCommand_GetResult_Response_);
TROUPE_DDS_TYPE(control_msgs_action_dds__GripperCommand_SendGoal_Request_);
TROUPE_DDS_TYPE(control_msgs_action_dds__GripperCommand_SendGoal_Response_);
TROUPE_DDS_TYPE(geometry_msgs_msg_dds__PoseStamped_);
TROUPE_DDS_TYPE(geometry_msgs_msg_dds__PoseWithCovarianceStamped_);
TROUPE_DDS_TYPE(geometry_msgs_msg_dds__Twist_);
TROUPE_DDS_TYPE(geometry_msgs_msg_dds__TwistStamped_);
TROUPE_DDS_TYPE(nav_msgs_msg_dds__OccupancyGrid_);
TROUPE_DDS_TYPE(nav_msgs_msg_dds__Odometry_);
TROUPE_DDS_TYPE(rcl_interfaces_msg_dds__Log_);
TROUPE_DDS_TYPE(rcl_interfaces_msg_dds__ParameterEvent_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__DescribeParameters_Request_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__DescribeParameters_Response_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__GetParameterTypes_Request_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__GetParameterTypes_Response_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__GetParameters_Request_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__GetParameters_Response_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__ListParameters_Request_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__ListParameters_Response_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__SetParametersAtomically_Request_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__SetParametersAtomically_Response_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__SetParameters_Request_);
TROUPE_DDS_TYPE(rcl_interfaces_srv_dds__SetParameters_Response_);
TROUPE_DDS_TYPE(rmw_dds_common_msg_dds__ParticipantEntitiesInfo_);
TROUPE_DDS_TYPE(rosgraph_msgs_msg_dds__Clock_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__CameraInfo_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__Image_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__Imu_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__JointState_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__BatteryState_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__LaserScan_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__PointCloud2_);
TROUPE_DDS_TYPE(sensor_msgs_msg_dds__Range_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntities_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntities_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntityState_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetEntityState_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetSimulationState_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetSimulationState_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__SetSimulationState_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__SetSimulationState_Response_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__StepSimulation_Request_);
TROUPE_DDS_TYPE(simulation_interfaces_srv_dds__StepSimulation_Response_);
TROUPE_DDS_TYPE(std_msgs_msg_dds__Bool_);
TROUPE_DDS_TYPE(std_msgs_msg_dds__Float64_);
TROUPE_DDS_TYPE(std_msgs_msg_dds__String_);
TROUPE_DDS_TYPE(tf2_msgs_msg_dds__TFMessage_);
TROUPE_DDS_TYPE(type_description_interfaces_srv_dds__GetTypeDescription_Request_);
TROUPE_DDS_TYPE(type_description_interfaces_srv_dds__GetTypeDescription_Response_);
TROUPE_DDS_TYPE(vision_msgs_msg_dds__Detection2DArray_);
TROUPE_DDS_TYPE(vision_msgs_msg_dds__Detection3DArray_);
TROUPE_DDS_TYPE(visualization_msgs_msg_dds__MarkerArray_);

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
