#include "ros/flags/ros_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "command_line/parse_command_line.h"

namespace troupe {
namespace {

using ros::CommandType;

CLI::Option* AddText(CLI::App& app, const std::string& group, const std::string& name, const std::string& help,
                     const std::vector<std::string>& words, const std::function<void(const std::string&)>& set) {
  return app.add_option_function<std::string>(name, set, help)->type_name("NAME")->check(OneOf(words))->group(group);
}

// The value of an enumeration, by its name.
template <NamedEnum Value>
void AddChoice(CLI::App& app, const std::string& group, const std::string& name, const std::string& help,
               const std::function<void(Value)>& set) {
  AddText(app, group, name, help, AllNames<Value>(), [set](const std::string& word) { set(*FindByName<Value>(word)); });
}

// An option replaces the environment, and with it the fault that the environment has.
void AddRosSecurityFlags(CLI::App& app, ros::RosSecurity& security, const std::string& group) {
  AddChoice<ros::SecurityStrategy>(
      app, group, "--ros-security",
      "Security in ROS: off, permissive or enforce (default: by ROS_SECURITY_ENABLE and ROS_SECURITY_STRATEGY)",
      [&security](ros::SecurityStrategy strategy) {
        security.fault.clear();
        security.strategy = strategy;
      });
  app.add_option("--ros-keystore", security.keystore,
                 "Keystore of ROS's security tools (default: ROS_SECURITY_KEYSTORE)")
      ->check(NotEmpty())
      ->type_name("DIR")
      ->group(group);
  app.add_option("--ros-enclave", security.enclave,
                 "Enclave of all processes (default: ROS_SECURITY_ENCLAVE_OVERRIDE, or /world and one for each robot)")
      ->type_name("/NAME")
      ->group(group);
}

// The arguments below are the inverses of the flags: what one program was told, another is told in the same words.
template <typename... Lists>
std::vector<std::string> Joined(Lists... lists) {
  std::vector<std::string> all;
  (all.insert(all.end(), lists.begin(), lists.end()), ...);
  return all;
}

std::vector<std::string> NameArguments(const ros::RosOptions& options) {
  std::vector<std::string> arguments = {std::string("--ros-tf=") +
                                        (options.names.namespaced_tf ? "namespaced" : "shared")};
  if (options.names.plain) arguments.emplace_back("--ros-names=plain");
  if (!options.socket.empty()) arguments.push_back("--ros-participant-socket=" + options.socket);
  return arguments;
}

std::vector<std::string> WorldTopicArguments(const ros::WorldTopics& world) {
  std::vector<std::string> arguments = {"--ros-clock-rate=" + CLI::detail::to_string(world.clock_rate)};
  if (world.map_resolution) {
    arguments.push_back("--ros-map-resolution=" + CLI::detail::to_string(*world.map_resolution));
  }
  if (world.map_height) arguments.push_back("--ros-map-height=" + CLI::detail::to_string(*world.map_height));
  return arguments;
}

std::vector<std::string> LockstepArguments(const RosLockstep& lockstep) {
  std::vector<std::string> arguments;
  for (const RosLockstepName& name : lockstep.names) arguments.push_back("--ros-lockstep=" + name.name);
  if (lockstep.period) arguments.push_back("--ros-lockstep-period=" + std::to_string(*lockstep.period));
  if (lockstep.limit_seconds) {
    arguments.push_back("--ros-lockstep-limit=" + CLI::detail::to_string(*lockstep.limit_seconds));
  }
  if (lockstep.ends_at_limit) {
    arguments.emplace_back(*lockstep.ends_at_limit ? "--ros-lockstep-at-limit=end"
                                                   : "--ros-lockstep-at-limit=continue");
  }
  return arguments;
}

}  // namespace

void AddRosNetworkFlags(CLI::App& app, ros::RosNetwork& network, ros::EnvironmentFaults& faults,
                        const std::string& group) {
  app.add_option("--ros-domain", network.domain, "ROS domain (default: ROS_DOMAIN_ID, or 0)")
      ->check(DdsDomain())
      ->each([&faults](const std::string&) { faults.domain.clear(); })
      ->type_name("D")
      ->group(group);
  app.add_option("--ros-interface", network.network_interface,
                 "Network interface to ROS 2; auto: chosen by DDS (default), or lo if Humble stays on this host")
      ->type_name("NAME")
      ->group(group);
  AddChoice<ros::DiscoveryRange>(
      app, group, "--ros-discovery",
      "Who discovers this run: off, localhost, subnet or system-default (default: as ROS_AUTOMATIC_DISCOVERY_RANGE "
      "or ROS_LOCALHOST_ONLY says, or subnet)",
      [&network, &faults](ros::DiscoveryRange range) {
        network.discovery = range;
        faults.discovery.clear();
      });
  app.add_option("--ros-peers", network.static_peers,
                 "Other hosts to look for ROS 2 on, separated by commas (default: ROS_STATIC_PEERS)")
      ->delimiter(',')
      ->type_name("HOSTS")
      ->group(group);
  AddChoice<ros::Distribution>(app, group, "--ros-distro",
                               "ROS 2 distribution to be compatible with (default: ROS_DISTRO, or jazzy)",
                               [&network, &faults](ros::Distribution distribution) {
                                 network.distribution = distribution;
                                 faults.distribution.clear();
                               });
  AddChoice<ros::ServiceClients>(
      app, group, "--ros-services",
      "Programs whose service calls are answered, by their RMW: cyclone, fastrtps or both (default: both where "
      "Troupe was built with Fast DDS, else cyclone)",
      [&network](ros::ServiceClients clients) { network.service_clients = clients; });
  AddRosSecurityFlags(app, network.security, group);
}

void AddRosFlags(CLI::App& app, std::optional<bool>& on, ros::RosOptions& options, const std::string& group) {
  app.add_flag_callback(
         "--ros", [&on] { on = true; }, "Publish the robots to ROS 2, and accept commands from it")
      ->group(group);
  app.add_flag_callback(
         "--no-ros", [&on] { on = false; }, "Do not use ROS 2 (default)")
      ->group(group);
  AddRosNetworkFlags(app, options.network, options.faults, group);
  AddText(app, group, "--ros-tf", "shared (default): /tf for all robots; namespaced: /ROBOT/tf for each robot",
          {"shared", "namespaced"},
          [&names = options.names](const std::string& word) { names.namespaced_tf = word == "namespaced"; });
  AddText(app, group, "--ros-names", "robot (default): topics below /ROBOT; plain: /odom, /scan ... of a single robot",
          {"robot", "plain"}, [&names = options.names](const std::string& word) { names.plain = word == "plain"; });
  app.add_option("--ros-participant-socket", options.socket,
                 "Name of the socket at which the ros-participant of this host listens")
      ->type_name("NAME")
      ->group("");
}

void AddRobotTopicFlags(CLI::App& app, ros::RobotTopics& robots, const std::string& group) {
  AddChoice<CommandType>(app, group, "--ros-cmd-vel",
                         "Message types accepted on cmd_vel: twist (default), stamped or both",
                         [&robots](CommandType type) { robots.command_type = type; });
  app.add_flag("--ros-reliable-commands", robots.reliable_commands,
               "Accept commands of reliable writers only, which can wait for acknowledgement")
      ->group(group);
  app.add_option("--ros-command-timeout", robots.command_timeout,
                 fmt::format("Simulated seconds for which a command is valid; 0: no limit (default: {})",
                             robots.command_timeout))
      ->check(NumberFromZero())
      ->type_name("SECONDS")
      ->group(group);
  AddText(app, group, "--ros-no-hit",
          "What a ray of a scan without a hit reads: inf or range-max (default: as the scenario says, or inf)",
          {"inf", "range-max"}, [&robots](const std::string& word) { robots.infinite_ranges = word == "inf"; });
  app.add_flag_callback(
         "--no-ros-map-odom", [&robots] { robots.map_to_odom = false; },
         "Leave the transform from map to odom to a localization node")
      ->group(group);
  app.add_flag_callback(
         "--no-ros-odom-base", [&robots] { robots.odom_to_base = false; },
         "Leave the transform from odom to base_link to a node that filters odometry")
      ->group(group);
}

void AddBuildingMapFlag(CLI::App& app, ros::WorldTopics& world, const std::string& group) {
  AddText(app, group, "--ros-map",
          "What /map is: grid: the occupancy grid (default); building: of a building, its map for Open-RMF, with the "
          "occupancy grid on /occupancy_grid",
          {"grid", "building"}, [&world](const std::string& word) { world.building_map = word == "building"; });
}

void AddWorldTopicFlags(CLI::App& app, ros::WorldTopics& world, const std::string& group) {
  app.add_option("--ros-clock-rate", world.clock_rate,
                 "Rate of /clock in Hz of wall time, between the ticks; 0: each tick (default)")
      ->check(NumberFromZero())
      ->type_name("HZ")
      ->group(group);
  app.add_option("--ros-map-resolution", world.map_resolution,
                 "Side of a cell of /map in metres (default: that of the world's ROS map, or 0.05)")
      ->check(PositiveNumber())
      ->type_name("METRES")
      ->group(group);
  app.add_option("--ros-map-height", world.map_height,
                 "Height of the horizontal section that /map shows, in metres (default: that of the lowest ranger)")
      ->check(NumberFromZero())
      ->type_name("METRES")
      ->group(group);
}

void AddPoseTopicFlags(CLI::App& app, ros::PoseTopics& topics, const std::string& group) {
  AddText(app, group, "--ros-rviz",
          "Topics of RViz that command robots: none (default); goal: goal_pose, the goal of the controller; pose: "
          "initialpose, the robot's pose in the world; both",
          {"none", "goal", "pose", "both"}, [&topics](const std::string& word) {
            topics.goals = word == "goal" || word == "both";
            topics.poses = word == "pose" || word == "both";
          });
}

void AddLockstepFlags(CLI::App& app, RosLockstep& lockstep, const std::string& group) {
  app.add_option_function<std::vector<std::string>>(
         "--ros-lockstep",
         [&lockstep](const std::vector<std::string>& names) {
           lockstep.names.clear();
           for (const std::string& name : names) lockstep.names.push_back({name});
         },
         "Ticks wait for these: topics that a node writes (/anna/cmd_vel; ~/cmd_vel: of each robot), or names of nodes "
         "that answer on /world/tick_done")
      ->delimiter(',')
      ->check(CLI::Validator(
          [](const std::string& name) {
            const Status status = CheckRosLockstepName(name);
            return status.ok() ? std::string() : status.error().message;
          },
          ""))
      ->type_name("NAME,...")
      ->group(group);
  app.add_option("--ros-lockstep-period", lockstep.period, "Wait at every K-th tick only (default: 1)")
      ->check(WholeNumber(1, 1'000'000))
      ->type_name("K")
      ->group(group);
  app.add_option("--ros-lockstep-limit", lockstep.limit_seconds,
                 fmt::format("Seconds of wall time that a tick waits for one that has answered before; 0: no limit "
                             "(default: {})",
                             RosLockstep::kDefaultLimitSeconds))
      ->check(NumberFromZero())
      ->type_name("SECONDS")
      ->group(group);
  AddText(app, group, "--ros-lockstep-at-limit",
          "At the limit: end the run (default), or continue without that one until it is heard of again",
          {"end", "continue"}, [&lockstep](const std::string& word) { lockstep.ends_at_limit = word == "end"; });
}

std::vector<std::string> ServiceRosArguments(const ros::RosOptions& options) {
  std::vector<std::string> map;
  if (options.world.building_map) map.emplace_back("--ros-map=building");
  std::vector<std::string> poses;
  if (options.pose_topics.goals || options.pose_topics.poses) {
    const bool both = options.pose_topics.goals && options.pose_topics.poses;
    poses.emplace_back(both ? "--ros-rviz=both" : options.pose_topics.goals ? "--ros-rviz=goal" : "--ros-rviz=pose");
  }
  return Joined(ros::NetworkArguments(options.network), NameArguments(options), WorldTopicArguments(options.world), map,
                poses, LockstepArguments(options.lockstep));
}

std::vector<std::string> AgentRosArguments(const ros::RosOptions& options) {
  const ros::RobotTopics& robots = options.robots;
  std::vector<std::string> of_robots = {
      std::string("--ros-cmd-vel=") + NameOf(robots.command_type),
      "--ros-command-timeout=" + CLI::detail::to_string(robots.command_timeout),
  };
  if (robots.reliable_commands) of_robots.emplace_back("--ros-reliable-commands");
  if (robots.infinite_ranges) {
    of_robots.emplace_back(*robots.infinite_ranges ? "--ros-no-hit=inf" : "--ros-no-hit=range-max");
  }
  if (!robots.map_to_odom) of_robots.emplace_back("--no-ros-map-odom");
  if (!robots.odom_to_base) of_robots.emplace_back("--no-ros-odom-base");
  return Joined(ros::NetworkArguments(options.network), NameArguments(options), WorldTopicArguments(options.world),
                of_robots);
}

}  // namespace troupe
