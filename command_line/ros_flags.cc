#include "command_line/ros_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "command_line/option_checks.h"

namespace troupe {
namespace {

using ros::CommandType;

CLI::Option* AddText(CLI::App& app, const std::string& group, const std::string& name, const std::string& help,
                     const std::vector<std::string>& words, const std::function<void(const std::string&)>& set) {
  return app.add_option_function<std::string>(name, set, help)->type_name("NAME")->check(OneOf(words))->group(group);
}

CommandType ParseCommandType(const std::string& word) {
  if (word == "both") return CommandType::kBoth;
  return word == "stamped" ? CommandType::kTwistStamped : CommandType::kTwist;
}

void AddRosMapFlags(CLI::App& app, ros::RosOptions& options, const std::string& group) {
  app.add_option("--ros-map-resolution", options.map_resolution,
                 fmt::format("Side of a cell of /map in metres (default: {})", options.map_resolution))
      ->check(PositiveNumber())
      ->type_name("METRES")
      ->group(group);
  app.add_option("--ros-map-height", options.map_height,
                 "Height of the horizontal section that /map shows, in metres (default: that of the lowest ranger)")
      ->check(NumberFromZero())
      ->type_name("METRES")
      ->group(group);
  app.add_flag_callback(
         "--no-ros-map-odom", [&options] { options.map_to_odom = false; },
         "Leave the transform from map to odom to a localization node")
      ->group(group);
  app.add_flag_callback(
         "--no-ros-odom-base", [&options] { options.odom_to_base = false; },
         "Leave the transform from odom to base_link to a node that filters odometry")
      ->group(group);
}

void AddRosSecurityFlags(CLI::App& app, ros::RosSecurity& security, const std::string& group) {
  AddText(app, group, "--ros-security",
          "Security in ROS: off, permissive or enforce (default: by ROS_SECURITY_ENABLE and ROS_SECURITY_STRATEGY)",
          {"off", "permissive", "enforce"}, [&security](const std::string& word) {
            security.fault.clear();
            for (const auto strategy :
                 {ros::SecurityStrategy::kOff, ros::SecurityStrategy::kPermissive, ros::SecurityStrategy::kEnforce}) {
              if (word == ToString(strategy)) security.strategy = strategy;
            }
          });
  app.add_option("--ros-keystore", security.keystore,
                 "Keystore of ROS's security tools (default: ROS_SECURITY_KEYSTORE)")
      ->type_name("DIR")
      ->group(group);
  app.add_option("--ros-enclave", security.enclave,
                 "Enclave of all processes (default: ROS_SECURITY_ENCLAVE_OVERRIDE, or /world and one for each robot)")
      ->type_name("/NAME")
      ->group(group);
}

}  // namespace

void AddRosFlags(CLI::App& app, std::optional<bool>& on, ros::RosOptions& options, const std::string& group) {
  app.add_flag_callback(
         "--ros", [&on] { on = true; }, "Publish the robots to ROS 2, and accept commands from it")
      ->group(group);
  app.add_flag_callback(
         "--no-ros", [&on] { on = false; }, "Do not use ROS 2 (default)")
      ->group(group);
  app.add_option("--ros-domain", options.domain, "ROS domain (default: ROS_DOMAIN_ID, or 0)")
      ->check(DdsDomain())
      ->each([&options](const std::string&) { options.faults.domain.clear(); })
      ->type_name("D")
      ->group(group);
  app.add_option("--ros-interface", options.network_interface,
                 "Network interface to ROS 2; auto: chosen by DDS (default), or lo if Humble stays on this host")
      ->type_name("NAME")
      ->group(group);
  AddText(app, group, "--ros-discovery",
          "Who discovers this run: off, localhost, subnet or system-default (default: as ROS_AUTOMATIC_DISCOVERY_RANGE "
          "or ROS_LOCALHOST_ONLY says, or subnet)",
          {"off", "localhost", "subnet", "system-default"}, [&options](const std::string& word) {
            options.discovery = *ros::ParseDiscoveryRange(word);
            options.faults.discovery.clear();
          });
  app.add_option("--ros-peers", options.static_peers,
                 "Other hosts to look for ROS 2 on, separated by commas (default: ROS_STATIC_PEERS)")
      ->delimiter(',')
      ->type_name("HOSTS")
      ->group(group);
  AddText(app, group, "--ros-distro", "ROS 2 distribution to be compatible with (default: ROS_DISTRO, or jazzy)",
          {"humble", "iron", "jazzy", "kilted", "rolling"}, [&options](const std::string& word) {
            options.distribution = *ros::ParseDistribution(word);
            options.faults.distribution.clear();
          });
  AddText(app, group, "--ros-cmd-vel", "Message types accepted on cmd_vel: twist (default), stamped or both",
          {"twist", "stamped", "both"},
          [&options](const std::string& word) { options.command_type = ParseCommandType(word); });
  app.add_flag("--ros-reliable-commands", options.reliable_commands,
               "Accept commands of reliable writers only, which can wait for acknowledgement")
      ->group(group);
  app.add_option("--ros-command-timeout", options.command_timeout,
                 fmt::format("Simulated seconds for which a command is valid; 0: no limit (default: {})",
                             options.command_timeout))
      ->check(NumberFromZero())
      ->type_name("SECONDS")
      ->group(group);
  app.add_option("--ros-clock-rate", options.clock_rate,
                 "Rate of /clock in Hz of wall time, between the ticks; 0: each tick (default)")
      ->check(NumberFromZero())
      ->type_name("HZ")
      ->group(group);
  AddText(app, group, "--ros-rviz",
          "Topics of RViz that command robots: none (default); goal: goal_pose, the goal of the controller; pose: "
          "initialpose, the robot's pose in the world; both",
          {"none", "goal", "pose", "both"}, [&options](const std::string& word) {
            options.goal_poses = word == "goal" || word == "both";
            options.initial_poses = word == "pose" || word == "both";
          });
  AddText(app, group, "--ros-no-hit",
          "What a ray of a scan without a hit reads: inf or range-max (default: as the scenario says, or inf)",
          {"inf", "range-max"}, [&options](const std::string& word) { options.infinite_ranges = word == "inf"; });
  AddText(app, group, "--ros-tf", "shared (default): /tf for all robots; namespaced: /ROBOT/tf for each robot",
          {"shared", "namespaced"},
          [&options](const std::string& word) { options.namespaced_tf = word == "namespaced"; });
  AddText(app, group, "--ros-names", "robot (default): topics below /ROBOT; plain: /odom, /scan ... of a single robot",
          {"robot", "plain"}, [&options](const std::string& word) { options.plain_names = word == "plain"; });
  AddText(app, group, "--ros-services",
          "Programs whose service calls are answered, by their RMW: cyclone, fastrtps or both (default: both where "
          "ros-service-bridge is installed, else cyclone)",
          {"cyclone", "fastrtps", "both"},
          [&options](const std::string& word) { options.service_clients = *ros::ParseServiceClients(word); });
  AddText(app, group, "--ros-participants",
          fmt::format("Participants of the robots in the ROS domain: one for each process or for each host (default: "
                      "process for up to {} processes, and with security; else host)",
                      ros::kMostMutualProcesses),
          {"process", "host"}, [&options](const std::string& word) {
            options.participants = word == "host" ? ros::ParticipantScope::kHost : ros::ParticipantScope::kProcess;
          });
  app.add_option("--ros-participant-socket", options.participant_socket,
                 "Name of the socket at which the ros-participant of this host listens")
      ->type_name("NAME")
      ->group("");
  app.add_option("--ros-relay", options.relay_port, "Port of the world service's relay of discovery")
      ->type_name("PORT")
      ->group("");
  AddRosMapFlags(app, options, group);
  AddRosSecurityFlags(app, options.security, group);
}

std::vector<std::string> RosArguments(const ros::RosOptions& options) {
  std::vector<std::string> arguments = {
      "--ros-domain=" + std::to_string(options.domain),
      "--ros-interface=" + options.network_interface,
      std::string("--ros-discovery=") + ToString(options.discovery),
      std::string("--ros-distro=") + ToString(options.distribution),
      std::string("--ros-cmd-vel=") + ToString(options.command_type),
      "--ros-command-timeout=" + CLI::detail::to_string(options.command_timeout),
      "--ros-clock-rate=" + CLI::detail::to_string(options.clock_rate),
      std::string("--ros-tf=") + (options.namespaced_tf ? "namespaced" : "shared"),
  };
  arguments.push_back("--ros-map-resolution=" + CLI::detail::to_string(options.map_resolution));
  if (options.map_height) arguments.push_back("--ros-map-height=" + CLI::detail::to_string(*options.map_height));
  if (options.reliable_commands) arguments.emplace_back("--ros-reliable-commands");
  arguments.push_back(std::string("--ros-security=") + ToString(options.security.strategy));
  if (!options.security.keystore.empty()) arguments.push_back("--ros-keystore=" + options.security.keystore);
  if (!options.security.enclave.empty()) arguments.push_back("--ros-enclave=" + options.security.enclave);
  for (const std::string& peer : options.static_peers) arguments.push_back("--ros-peers=" + peer);
  if (options.infinite_ranges) {
    arguments.emplace_back(*options.infinite_ranges ? "--ros-no-hit=inf" : "--ros-no-hit=range-max");
  }
  if (options.service_clients) {
    arguments.push_back(std::string("--ros-services=") + ToString(*options.service_clients));
  }
  if (options.participants) {
    arguments.push_back(std::string("--ros-participants=") + ToString(*options.participants));
  }
  if (!options.participant_socket.empty()) {
    arguments.push_back("--ros-participant-socket=" + options.participant_socket);
  }
  if (options.relay_port != 0) arguments.push_back("--ros-relay=" + std::to_string(options.relay_port));
  if (options.goal_poses || options.initial_poses) {
    const bool both = options.goal_poses && options.initial_poses;
    arguments.emplace_back(both ? "--ros-rviz=both" : options.goal_poses ? "--ros-rviz=goal" : "--ros-rviz=pose");
  }
  if (options.plain_names) arguments.emplace_back("--ros-names=plain");
  if (!options.map_to_odom) arguments.emplace_back("--no-ros-map-odom");
  if (!options.odom_to_base) arguments.emplace_back("--no-ros-odom-base");
  return arguments;
}

}  // namespace troupe
