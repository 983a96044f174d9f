#include "robot-agent/ros/position_input.h"

#include <fmt/format.h>

#include <cmath>

#include "ros/connection/ros_qos.h"

namespace troupe {

PositionInput::PositionInput(const ros::RosNode& node, const std::string& topic, const Interval& range)
    : topic_(node.Resolve(topic)), range_(range), reader_(node, topic, ros::Commands(true)) {}

std::optional<double> PositionInput::Latest() {
  std::optional<double> position;
  reader_.Drain([&](const ros::Float64& command) {
    if (std::isfinite(command.data)) {
      position = range_.Clamp(command.data);
    } else {
      refusals_.Count();
    }
  });
  return position;
}

std::optional<std::string> PositionInput::DrainReport() {
  const std::uint64_t refused = refusals_.CountToReport();
  if (refused == 0) return std::nullopt;
  return fmt::format("{}: ignored a command that is not finite ({} so far)", topic_, refused);
}

}  // namespace troupe
