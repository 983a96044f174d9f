// RobotList: where the robots of a run are in ROS now. The world service writes it for the ros-service-bridge, on a DDS
// topic in the partition of the run that is no topic of ROS.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "ros/messages/ros_options.h"
#include "troupe/world_description.h"

namespace troupe::ros {

inline constexpr const char* kRobotListTopic = "troupe_robots";
// Of the topic: that of std_msgs/String, whose text is the list.
inline constexpr const char* kRobotListType = "std_msgs::msg::dds_::String_";

struct RobotList {
  std::set<std::string> namespaces;  // of robots in the domain of the run: "/anna"
  std::set<std::uint32_t> domains;   // of robots with one of their own

  // Whether the service, "anna/robot/list_parameters", is of a robot in the domain of the run.
  bool HasService(const std::string& service) const;
  friend bool operator==(const RobotList&, const RobotList&) = default;
};

RobotList RobotListOf(const WorldDescription& world, const RosOptions& options);

std::string ToText(const RobotList& list);
// Nothing for any other text.
std::optional<RobotList> ParseRobotList(const std::string& text);

}  // namespace troupe::ros
