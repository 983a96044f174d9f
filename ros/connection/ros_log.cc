#include "ros/connection/ros_log.h"

#include <algorithm>
#include <chrono>

#include "ros/connection/ros_qos.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {
namespace {

// Loggers of ROS use the time of the system, not the simulated one.
Time SystemTime() {
  using std::chrono::nanoseconds;
  const auto now = std::chrono::duration_cast<nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {static_cast<std::int32_t>(now.count() / kSecond), static_cast<std::uint32_t>(now.count() % kSecond)};
}

}  // namespace

RosLog::RosLog(const RosNode& node) : writer_(node, "/rosout", LogLines()) {}

void RosLog::Share(const RosNode& node) {
  writer_.Share(node);
}

void RosLog::Write(LogLevel level, const std::string& node, const std::string& text) {
  dds::WireArena arena;
  rcl_interfaces_msg_dds__Log_ line{};
  line.stamp = SystemTime();
  line.level = static_cast<std::uint8_t>(level);
  line.name = arena.Copy(LoggerName(node));
  line.msg = arena.Copy(text);
  line.file = arena.Copy("");
  line.function = arena.Copy("");
  writer_.Write(line);
}

std::string LoggerName(const std::string& node) {
  std::string name = node.substr(node.starts_with("/") ? 1 : 0);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

}  // namespace troupe::ros
