// RosLog: the log of the nodes of a process in ROS, /rosout. One writer for all of them, because each node of ROS's own
// has one, and a hundred robots would add a hundred.
#pragma once

#include <cstdint>
#include <string>

#include "ros/connection/ros_endpoints.h"

namespace troupe::ros {

enum class LogLevel : std::uint8_t { kInfo = 20, kWarning = 30 };

class RosLog {
 public:
  explicit RosLog(const RosNode& node);

  // Shows the writer as that of another node, too.
  void Share(const RosNode& node);

  // `node`: "/anna/robot". Any thread may call it, one at a time.
  void Write(LogLevel level, const std::string& node, const std::string& text);

 private:
  RosWriter<rcl_interfaces_msg_dds__Log_> writer_;
};

// The name of a node's logger: "anna.robot" for "/anna/robot".
std::string LoggerName(const std::string& node);

}  // namespace troupe::ros
