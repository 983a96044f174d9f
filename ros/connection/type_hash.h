// Type hashes: ROS 2 from Iron on announces one for the type of each endpoint, shows them and compares them in
// recordings.
#pragma once

#include <string>

#include "ros/messages/ros_options.h"

namespace troupe::ros {

// A JSON object from ROS type names to hashes, of Jazzy: configs/ros-type-hashes-jazzy.json.
extern const char* const kTypeHashesText;

// "std_msgs/msg/String" for "std_msgs::msg::dds_::String_"; "" if the name is not that of a ROS type on DDS.
std::string RosTypeName(const std::string& dds_type_name);

// "RIHS01_..." of a ROS type on DDS; "" if it is not known.
std::string TypeHash(const std::string& dds_type_name);
// The same of "std_msgs/msg/String".
std::string HashOfRosType(const std::string& ros_type);

// In the user data of an endpoint of this type on DDS: "typehash=RIHS01_...;". From Iron on ROS warns of each endpoint
// without it, once for each command. Empty for Humble, which knows no hashes.
std::string TypeMark(Distribution distribution, const std::string& dds_type_name);

}  // namespace troupe::ros
