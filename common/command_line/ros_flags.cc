#include "common/command_line/ros_flags.h"

#include <CLI/CLI.hpp>

#include "common/command_line/option_checks.h"

namespace troupe {
namespace {

using ros::CommandType;
using ros::Distribution;

CLI::Option* AddText(CLI::App& app, const std::string& group, const std::string& name, const char* help,
                     const std::vector<std::string>& words, std::function<void(const std::string&)> set) {
  return app.add_option_function<std::string>(name, std::move(set), help)
      ->type_name("NAME")
      ->check(OneOf(words))
      ->group(group);
}

CommandType ParseCommandType(const std::string& word) {
  if (word == "both") return CommandType::kBoth;
  return word == "stamped" ? CommandType::kTwistStamped : CommandType::kTwist;
}

}  // namespace

void AddRosFlags(CLI::App& app, RosFlags& flags, const std::string& group) {
  ros::RosOptions& options = flags.options;
  app.add_flag_callback(
         "--ros", [&flags] { flags.on = true; }, "Show the robots to ROS 2, and let it drive them")
      ->group(group);
  app.add_flag_callback(
         "--no-ros", [&flags] { flags.on = false; }, "Do not (default)")
      ->group(group);
  app.add_option("--ros-domain", options.domain, "ROS domain (default: ROS_DOMAIN_ID, or 0)")
      ->check(DdsDomain())
      ->type_name("D")
      ->group(group);
  app.add_option("--ros-interface", options.network_interface,
                 "Network interface to ROS, or auto (default: auto; lo if ROS_LOCALHOST_ONLY is 1)")
      ->type_name("NAME")
      ->group(group);
  AddText(app, group, "--ros-distro", "Distribution to be understood by (default: ROS_DISTRO, or jazzy)",
          {"humble", "iron", "jazzy", "kilted", "rolling"},
          [&options](const std::string& word) { options.distribution = *ros::ParseDistribution(word); });
  AddText(app, group, "--ros-cmd-vel", "Types of cmd_vel: twist (default), stamped or both",
          {"twist", "stamped", "both"},
          [&options](const std::string& word) { options.command_type = ParseCommandType(word); });
  app.add_flag("--ros-reliable-commands", options.reliable_commands,
               "Take commands of reliable writers only, which can wait until they have arrived")
      ->group(group);
  app.add_option("--ros-command-timeout", options.command_timeout,
                 "Simulated seconds for which a command counts; 0: for ever (default: 5)")
      ->check(NumberFromZero())
      ->type_name("SECONDS")
      ->group(group);
  AddText(app, group, "--ros-tf", "shared (default): /tf for all robots; namespaced: /ROBOT/tf for each",
          {"shared", "namespaced"},
          [&options](const std::string& word) { options.namespaced_tf = word == "namespaced"; });
  app.add_option("--ros-map-resolution", options.map_resolution, "Side of a cell of /map (default: 0.05)")
      ->check(PositiveNumber())
      ->type_name("METRES")
      ->group(group);
  app.add_option("--ros-map-height", options.map_height,
                 "Height of the things on /map (default: that of the lowest scanner)")
      ->check(NumberFromZero())
      ->type_name("METRES")
      ->group(group);
  app.add_flag_callback(
         "--no-ros-map-odom", [&options] { options.map_to_odom = false; },
         "Leave the transform from map to odom to a localization node")
      ->group(group);
}

std::vector<std::string> RosArguments(const ros::RosOptions& options) {
  std::vector<std::string> arguments = {
      "--ros-domain=" + std::to_string(options.domain),
      "--ros-interface=" + options.network_interface,
      std::string("--ros-distro=") + ToString(options.distribution),
      std::string("--ros-cmd-vel=") + ToString(options.command_type),
      "--ros-command-timeout=" + CLI::detail::to_string(options.command_timeout),
      std::string("--ros-tf=") + (options.namespaced_tf ? "namespaced" : "shared"),
  };
  arguments.push_back("--ros-map-resolution=" + CLI::detail::to_string(options.map_resolution));
  if (options.map_height) arguments.push_back("--ros-map-height=" + CLI::detail::to_string(*options.map_height));
  if (options.reliable_commands) arguments.emplace_back("--ros-reliable-commands");
  if (!options.map_to_odom) arguments.emplace_back("--no-ros-map-odom");
  return arguments;
}

}  // namespace troupe
