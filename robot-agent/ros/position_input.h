// PositionInput: commanded positions on a topic of std_msgs/Float64.
#pragma once

#include <optional>
#include <string>

#include "robot-agent/ros/refusals.h"
#include "ros/connection/ros_endpoints.h"
#include "troupe/world_description.h"

namespace troupe {

class PositionInput {
 public:
  // The reader is reliable, because such a command is often sent only once.
  PositionInput(const ros::RosNode& node, const std::string& topic, const Interval& range);

  // The newest position received since the last call, clamped to the range.
  std::optional<double> Latest();

  // One line about commands refused since the last call; usually none.
  std::optional<std::string> DrainReport();

 private:
  std::string topic_;
  Interval range_;
  ros::RosReader<ros::Float64> reader_;
  Refusals refusals_;
};

}  // namespace troupe
