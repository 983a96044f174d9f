// The descriptions of the ROS types of Troupe's topics and services (REP 2011): their fields, and the types in them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

}  // namespace troupe::ros
