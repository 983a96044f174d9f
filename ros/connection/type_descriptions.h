// The descriptions of the ROS types of Troupe's topics and services (REP 2011): their fields, and the types in them.
// From Iron on, tools ask a node for them to read topics of unknown types. They are printed from the descriptors that
// idlc has made, and not kept a second time by hand.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ros/messages/ros_options.h"

namespace troupe::ros {

// configs/ros-type-descriptions-jazzy.txt, compiled in.
extern const char* const kTypeDescriptionsText;

struct DescribedField {
  std::string name;
  std::uint8_t type = 0;       // as in type_description_interfaces/msg/FieldType
  std::uint64_t capacity = 0;  // of an array or a bounded sequence
  std::uint64_t string_capacity = 0;
  std::string nested_type;  // empty unless it is a message, or several
};

struct DescribedType {
  std::string name;  // "std_msgs/msg/String"
  std::vector<DescribedField> fields;
};

// The type and all types in it, these sorted by name; nothing for a type that Troupe does not use.
std::vector<DescribedType> DescribeType(const std::string& ros_type);

// Type hashes: ROS 2 from Iron on announces one for the type of each endpoint, shows them and compares them in
// recordings.

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
