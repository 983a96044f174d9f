// The ROS 2 messages that Troupe sends and receives: the C structs that idlc makes from idl/ros. A message does not own
// its strings and sequences: they belong to a dds::WireArena in a message to send, to Cyclone in a received one.
// So a message is cheap to make and to drop: one arena for all its parts, freed at once.
#pragma once

#include "idl/ros/geometry.h"
#include "idl/ros/humble.h"
#include "idl/ros/navigation.h"
#include "idl/ros/people.h"
#include "idl/ros/sensors.h"
#include "idl/ros/std.h"
#include "idl/ros/vision.h"
#include "idl/ros/visualization.h"

namespace troupe::ros {

using Time = builtin_interfaces_msg_dds__Time_;
using Header = std_msgs_msg_dds__Header_;
using Bool = std_msgs_msg_dds__Bool_;
using Float64 = std_msgs_msg_dds__Float64_;
using String = std_msgs_msg_dds__String_;
using Clock = rosgraph_msgs_msg_dds__Clock_;
using PoseMessage = geometry_msgs_msg_dds__Pose_;
using TwistMessage = geometry_msgs_msg_dds__Twist_;
using TwistStamped = geometry_msgs_msg_dds__TwistStamped_;
using TransformStamped = geometry_msgs_msg_dds__TransformStamped_;
using TfMessage = tf2_msgs_msg_dds__TFMessage_;
using OdometryMessage = nav_msgs_msg_dds__Odometry_;
using OccupancyGridMessage = nav_msgs_msg_dds__OccupancyGrid_;
using LaserScan = sensor_msgs_msg_dds__LaserScan_;
using RangeMessage = sensor_msgs_msg_dds__Range_;
using HumbleRangeMessage = humble_sensor_msgs_msg_dds__Range_;
using ImageMessage = sensor_msgs_msg_dds__Image_;
using ImuMessage = sensor_msgs_msg_dds__Imu_;
using CameraInfo = sensor_msgs_msg_dds__CameraInfo_;
using PointCloud2 = sensor_msgs_msg_dds__PointCloud2_;
using JointStateMessage = sensor_msgs_msg_dds__JointState_;
using Detection2dArray = vision_msgs_msg_dds__Detection2DArray_;
using Detection3dArray = vision_msgs_msg_dds__Detection3DArray_;
using PeopleMessage = people_msgs_msg_dds__People_;
using BatteryState = sensor_msgs_msg_dds__BatteryState_;
using Marker = visualization_msgs_msg_dds__Marker_;
using MarkerArray = visualization_msgs_msg_dds__MarkerArray_;

}  // namespace troupe::ros
