// RosOptions: the settings of the connection to ROS 2. docs/ros2.md explains each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ros/messages/ros_security.h"

namespace troupe::ros {

enum class Distribution : std::uint8_t { kHumble, kIron, kJazzy, kKilted, kRolling };

// The message types of commands on cmd_vel.
enum class CommandType : std::uint8_t { kTwist, kTwistStamped, kBoth };

// The programs whose calls of services are answered: those on rmw_cyclonedds by the processes of the run, those on
// rmw_fastrtps by a ros-service-bridge.
enum class ServiceClients : std::uint8_t { kCyclone, kFastDds, kBoth };

// The participants of a run's robots in its ROS domain.
enum class ParticipantScope : std::uint8_t { kProcess, kHost };

// More processes than these do not discover each other, because discovery would grow with the square of their number.
inline constexpr std::size_t kMostMutualProcesses = 10;

// Which other participants are discovered, as ROS_AUTOMATIC_DISCOVERY_RANGE states it.
enum class DiscoveryRange : std::uint8_t { kOff, kLocalhost, kSubnet, kSystemDefault };

// Values of the environment that are not valid, as messages; empty: none.
struct EnvironmentFaults {
  std::string domain;
  std::string distribution;
  std::string discovery;  // ROS itself continues with localhost
};

struct RosOptions {
  std::uint32_t domain = 0;
  std::string network_interface = "auto";
  DiscoveryRange discovery = DiscoveryRange::kSubnet;
  std::vector<std::string> static_peers;  // hosts; only for ranges localhost and subnet
  Distribution distribution = Distribution::kJazzy;
  CommandType command_type = CommandType::kTwist;
  bool reliable_commands = false;         // then only reliable writers match, and they can wait for acknowledgment
  double command_timeout = 5.0;           // simulated s after which a command expires; 0: never
  double clock_rate = 0.0;                // Hz of wall time at which /clock advances between ticks; 0: only at ticks
  bool namespaced_tf = false;             // /<robot>/tf with plain frame names, in place of /tf with prefixed ones
  bool goal_poses = false;                // /<robot>/goal_pose sets the goal of the robot's controller
  bool initial_poses = false;             // /<robot>/initialpose sets the robot's pose in the world
  bool plain_names = false;               // the first robot of the domain has topics without its name
  double map_resolution = 0.05;           // m, side of a cell of /map
  std::optional<double> map_height = {};  // m, height of the section that /map shows; none: UsualMapHeight
  // For one of many processes, which need not discover each other: its own announcements do not reach the other
  // processes on this machine; they discover it by theirs. Without effect on the loopback interface.
  bool quiet = false;
  std::uint16_t relay_port = 0;              // of a DiscoveryRelay on this machine, for a quiet participant; 0: none
  bool map_to_odom = true;                   // publish the true pose of each odom frame in the map
  bool odom_to_base = true;                  // publish the robot's estimate as a transform, beside the topic odom
  std::optional<bool> infinite_ranges = {};  // RunSettings::ros_infinite_ranges; nothing: the scenario's
  // Nothing: the launcher chooses; in other programs as kCyclone.
  std::optional<ServiceClients> service_clients = {};
  // Nothing: as UsesHostParticipants says.
  std::optional<ParticipantScope> participants = {};
  std::string participant_socket = {};  // where the participant of this host listens; empty: there is none
  std::string session = {};             // of the run; part of the name of its bridge's partition
  RosSecurity security = {};
  EnvironmentFaults faults = {};  // of settings that no option has replaced
};

// The settings of the environment: ROS_DOMAIN_ID, ROS_DISTRO, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE,
// ROS_STATIC_PEERS, and those of SecurityFromEnvironment.
RosOptions OptionsFromEnvironment();

// `name`: in lower case.
std::optional<Distribution> ParseDistribution(const std::string& name);
std::optional<DiscoveryRange> ParseDiscoveryRange(const std::string& name);
std::optional<ServiceClients> ParseServiceClients(const std::string& name);
const char* ToString(Distribution distribution);
const char* ToString(DiscoveryRange range);  // "system-default"
const char* ToString(CommandType type);
const char* ToString(ServiceClients clients);
const char* ToString(ParticipantScope scope);

// How many processes the robots of a run are in; `robots_per_process` 0 counts as 1.
std::size_t ProcessesOf(std::size_t robots, std::size_t robots_per_process);

// Whether the robots of a host share a participant, the program ros-participant: by default those of more than
// kMostMutualProcesses processes. Not with security, where each robot has keys of its own.
bool UsesHostParticipants(const RosOptions& options, std::size_t processes);

// Whether the services of this run are reached through a ros-service-bridge. It has no keys, and cannot discover a run
// that is discovered by no program.
bool UsesBridge(const RosOptions& options);

// The DDS partition in which a bridge reaches the services of a run.
std::string BridgePartition(const std::string& session);

}  // namespace troupe::ros
