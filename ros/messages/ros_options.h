// RosOptions: the settings of the connection to ROS 2. docs/ros2.md explains each.
// Plain values without DDS, so that one program can pass them on to another as arguments.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/run/ros_lockstep.h"
#include "troupe/enum_names.h"
#include "troupe/result.h"

namespace troupe::ros {

enum class SecurityStrategy : std::uint8_t {
  kOff,
  kPermissive,  // a participant without keys has no security
  kEnforce,     // a participant without keys is an error
};
constexpr auto NamesOf(SecurityStrategy) {
  return std::array{"off", "permissive", "enforce"};
}

// RosSecurity: the keys of participants in a ROS domain, in a keystore as ROS 2's own tools (sros2) make it.
struct RosSecurity {
  SecurityStrategy strategy = SecurityStrategy::kOff;
  std::string keystore;  // a folder; empty: none
  std::string enclave;   // of all participants, "/swarm"; empty: each has its own
  std::string fault;     // of the environment, as an error message; empty: none
};

// ROS_SECURITY_ENABLE (true or false), ROS_SECURITY_STRATEGY (Enforce or Permissive, the default),
// ROS_SECURITY_KEYSTORE and ROS_SECURITY_ENCLAVE_OVERRIDE.
RosSecurity SecurityFromEnvironment();

// The keys of one participant.
struct Enclave {
  std::string name = "/";  // as the participant announces it
  std::string folder;      // of its keys; empty: without security
  std::string warning;     // its reason, if security was wanted; else empty
};

inline constexpr const char* kWorldEnclave = "/world";

// `own_name`: "/world", or "/<robot>" with the robot's name in ROS. Fails if files are missing and the strategy is
// kEnforce, and for a fault of the environment.
Result<Enclave> FindEnclave(const RosSecurity& security, const std::string& own_name);

enum class Distribution : std::uint8_t { kHumble, kIron, kJazzy, kKilted, kLyrical, kRolling };
constexpr auto NamesOf(Distribution) {
  return std::array{"humble", "iron", "jazzy", "kilted", "lyrical", "rolling"};
}

// The message types of commands on cmd_vel.
enum class CommandType : std::uint8_t { kTwist, kTwistStamped, kBoth };
constexpr auto NamesOf(CommandType) {
  return std::array{"twist", "stamped", "both"};
}

// The programs whose calls of services are answered, by their RMW.
enum class ServiceClients : std::uint8_t { kCyclone, kFastDds, kBoth };
constexpr auto NamesOf(ServiceClients) {
  return std::array{"cyclone", "fastrtps", "both"};
}

// Which other participants are discovered, as ROS_AUTOMATIC_DISCOVERY_RANGE states it.
enum class DiscoveryRange : std::uint8_t { kOff, kLocalhost, kSubnet, kSystemDefault };
constexpr auto NamesOf(DiscoveryRange) {
  return std::array{"off", "localhost", "subnet", "system-default"};
}

// Values of the environment that are not valid, as messages; empty: none.
struct EnvironmentFaults {
  std::string domain;
  std::string distribution;
  std::string discovery;  // ROS itself continues with localhost
  std::string rmw;        // its programs do not find the run
};

// The settings of the program that has participants in ROS, equal for all processes of a run on a host.
struct RosNetwork {
  std::uint32_t domain = 0;  // of the run
  std::string network_interface = "auto";
  DiscoveryRange discovery = DiscoveryRange::kSubnet;
  std::vector<std::string> static_peers = {};  // hosts; only for ranges localhost and subnet
  Distribution distribution = Distribution::kJazzy;
  // Nothing: kBoth where this build has Fast DDS, else kCyclone.
  std::optional<ServiceClients> service_clients = {};
  RosSecurity security = {};
};

// The names of robots in ROS: equal for all processes of a run.
struct RosNames {
  bool plain = false;          // the first robot of the run's domain has topics without its name
  bool namespaced_tf = false;  // /<robot>/tf with plain frame names, in place of /tf with prefixed ones
};

// What a robot publishes and accepts: of an agent.
struct RobotTopics {
  CommandType command_type = CommandType::kTwist;
  bool reliable_commands = false;            // then only reliable writers match, and they can wait for acknowledgment
  double command_timeout = 5.0;              // simulated s after which a command expires; 0: never
  bool map_to_odom = true;                   // publish the true pose of each odom frame in the map
  bool odom_to_base = true;                  // publish the robot's estimate as a transform, beside the topic odom
  std::optional<bool> infinite_ranges = {};  // RunSettings::ros_infinite_ranges; nothing: the scenario's
};

// /clock and /map: of the world service, and of the agent of a robot in a domain of its own.
struct WorldTopics {
  double clock_rate = 0.0;    // Hz of wall time at which /clock advances between ticks; 0: only at ticks
  bool building_map = false;  // of a building /map is the map for Open-RMF, and /occupancy_grid the occupancy grid
  std::optional<double> map_resolution = {};  // m, side of a cell of /map; none: that of the ROS map, or 0.05
  std::optional<double> map_height = {};      // m, height of the section that /map shows; none: UsualMapHeight
};

// The topics by which RViz commands robots: of the world service.
struct PoseTopics {
  bool goals = false;  // /<robot>/goal_pose sets the goal of the robot's controller
  bool poses = false;  // /<robot>/initialpose sets the robot's pose in the world
};

// All settings of a run with ROS. A process uses the parts that it needs.
struct RosOptions {
  RosNetwork network = {};
  RosNames names = {};
  RobotTopics robots = {};
  WorldTopics world = {};
  PoseTopics pose_topics = {};
  RosLockstep lockstep = {};
  std::string socket = {};        // at which the program ros-participant of this host listens
  EnvironmentFaults faults = {};  // of settings that no option has replaced
};

// The settings of the environment: ROS_DOMAIN_ID, ROS_DISTRO, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE,
// ROS_STATIC_PEERS, RMW_IMPLEMENTATION, and those of SecurityFromEnvironment.
RosOptions OptionsFromEnvironment();

// The arguments that give the same settings to another program.
std::vector<std::string> NetworkArguments(const RosNetwork& network);

// Whether its services of simulation_interfaces have the layouts of 2.x.
inline bool HasSimulationInterfaces2(Distribution distribution) {
  return distribution >= Distribution::kLyrical;
}

// Whether this build has Fast DDS.
bool HasFastDds();
// Whether services are served by Fast DDS, too. It has no keys, and cannot serve a run that is discovered by no
// program.
bool UsesFastDds(const RosNetwork& network);

}  // namespace troupe::ros
