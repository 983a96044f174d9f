// PositionInput: positions that somebody commands on a topic, std_msgs/Float64.
#pragma once

#include <optional>
#include <string>

#include "common/model/world_description.h"
#include "common/ros_dds/ros_endpoints.h"
#include "robot-agent/ros/refusals.h"

namespace troupe {

class PositionInput {
 public:
  // Reads reliably, because such a command is often sent only once.
  PositionInput(const ros::RosNode& node, const std::string& topic, const Interval& range);

  // The newest one since the last call, bounded to the range.
  std::optional<double> Take();

  // What went wrong since the last call, in one line; usually "".
  std::string TakeReport();

 private:
  std::string topic_;
  Interval range_;
  ros::RosReader<ros::Float64> reader_;
  Refusals refusals_;
};

}  // namespace troupe
