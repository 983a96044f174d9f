// How Troupe shows itself to ROS 2. docs/ros2.md explains each setting.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace troupe::ros {

enum class Distribution : std::uint8_t { kHumble, kIron, kJazzy, kKilted, kRolling };

// The types that commands on cmd_vel may have.
enum class CommandType : std::uint8_t { kTwist, kTwistStamped, kBoth };

struct RosOptions {
  std::uint32_t domain = 0;
  std::string network_interface = "auto";
  Distribution distribution = Distribution::kJazzy;
  CommandType command_type = CommandType::kTwist;
  bool reliable_commands = false;  // only reliable writers can command then, and they can wait for acknowledgment
  double command_timeout = 5.0;    // simulated s after which a command counts no more; 0: it counts for ever
  bool namespaced_tf = false;      // /<robot>/tf with plain frame names, in place of /tf with prefixed ones
  double map_resolution = 0.05;    // m, side of a cell of /map
  std::optional<double> map_height = {};  // m; what stands at that height is on /map; nothing: UsualMapHeight
  // For one of many processes, which need not meet each other: others on this machine meet it when they announce
  // themselves, not when it does. Without effect on the loopback interface.
  bool quiet = false;
  bool map_to_odom = true;  // publish where each odom frame is in the map: the truth
};

// What the environment says: ROS_DOMAIN_ID, ROS_DISTRO, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE; values that
// mean nothing are passed over.
RosOptions OptionsFromEnvironment();

// By lower-case name.
std::optional<Distribution> ParseDistribution(const std::string& name);
const char* ToString(Distribution distribution);
const char* ToString(CommandType type);

}  // namespace troupe::ros
