// troupe loopback: a run that takes the place of nav2_loopback_sim, with the topics and parameters of that.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "common/base/file.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "launcher/commands/loopback_robot.h"
#include "launcher/commands/run_command.h"
#include "launcher/commands/temporary_folder.h"

namespace troupe {
namespace {

using Json = nlohmann::ordered_json;

struct LoopbackOptions {
  RunOptions run;
  std::string parameters;                // file; empty: the defaults
  std::vector<double> pose = {0, 0, 0};  // m, m, degrees
  // Options of the command line, which count before the parameters.
  bool has_speed = false;
  bool has_commands = false;
};

std::string Absolute(const std::string& path) {
  std::error_code failure;
  const std::filesystem::path absolute = std::filesystem::absolute(path, failure);
  return failure ? path : absolute.lexically_normal().string();
}

// The scenario of a map with the robot: `robot` is the path of its file. The own one is as fast as it is told.
std::string LoopbackScenario(const LoopbackOptions& options, const LoopbackParameters& parameters,
                             const std::string& robot, bool is_own) {
  Json properties = {{"localization", "gps"}};
  if (is_own) properties["velocity_bounds"] = {-10, 10, -10, 10, 0, 0, -720, 720};
  const Json scenario = {
      {"world", Absolute(options.run.file)},
      {"name", std::filesystem::path(options.run.file).stem().string()},
      {"ros", true},
      {"properties", {{"interval_sim", 1000.0 * parameters.update_duration}}},
      {"robots",
       {{{"model", robot},
         {"name", "robot"},
         {"pose", options.pose},
         {"controller", "idle"},
         {"properties", std::move(properties)}}}},
  };
  return scenario.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int LoopbackCommand(LoopbackOptions options, const std::vector<std::string>& ros_options) {
  LoopbackParameters parameters;
  if (!options.parameters.empty()) {
    const Result<ReadParameters> read = ReadLoopbackParameters(options.parameters);
    if (!read.ok()) return Fail(read.error());
    for (const Warning& warning : read.value().warnings) PrintPlain(stderr, "{}\n", warning.ToString());
    parameters = read.value().parameters;
  }
  if (options.run.load.robots.size() > 1) {
    return Fail({{}, "found two robots of --robot, expected one: a scenario has others, each with its 'ros_domain'"});
  }
  if (!options.run.load.robots.empty() && options.run.load.robots.front().find('@') != std::string::npos) {
    return Fail({{}, "found a place in --robot, expected a file: --pose X,Y,HEADING is where the robot starts"});
  }
  const TemporaryFolder folder;
  const bool is_own = options.run.load.robots.empty();
  std::string robot = folder.path() + "/robot.urdf";
  if (!is_own) {
    robot = Absolute(options.run.load.robots.front());
    options.run.load.robots.clear();
  } else if (const Status failure = WriteWholeFile(robot, LoopbackRobot(parameters)); !failure.ok()) {
    return Fail(failure.error());
  }
  // A scenario has its robots, objects and people; a map needs one.
  const bool is_map = !options.run.file.ends_with(".json");
  if (is_map) {
    const std::string scenario =
        folder.path() + "/" + std::filesystem::path(options.run.file).stem().string() + ".json";
    const Status failure = WriteWholeFile(scenario, LoopbackScenario(options, parameters, robot, is_own));
    if (!failure.ok()) return Fail(failure.error());
    options.run.file = scenario;
  } else {
    options.run.load.robots = {fmt::format("{}@{},{},{}", robot, options.pose[0], options.pose[1], options.pose[2])};
  }
  RunOptions& run = options.run;
  run.run.ros = true;
  run.ros.names.plain = true;
  run.ros.pose_topics.poses = true;
  run.ros.robots.map_to_odom = run.ros.robots.map_to_odom && parameters.publishes_map_to_odom;
  if (!run.ros.robots.infinite_ranges) run.ros.robots.infinite_ranges = parameters.infinite_ranges;
  if (!options.has_commands) {
    run.ros.robots.command_type = parameters.stamped_commands ? ros::CommandType::kBoth : ros::CommandType::kTwist;
  }
  if (!options.has_speed) run.run.speed = Speed{parameters.speed};
  return RunWorld(std::move(run), ros_options);
}

}  // namespace

void AddLoopbackCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand(
      "loopback", "Run a map with a robot for Nav2, in place of nav2_loopback_sim, with its topics and parameters");
  const auto options = std::make_shared<LoopbackOptions>();
  AddRunOptions(*command, options->run);
  const char* group = "Loopback";
  command
      ->add_option("--params", options->parameters,
                   "A file of ROS parameters, with those of the node loopback_simulator (default: its defaults)")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group(group);
  command
      ->add_option("--pose", options->pose,
                   "Where the robot starts: m, m, degrees (default: 0,0,0); /initialpose moves it")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,HEADING")
      ->group(group);
  command->final_callback([command, options, &exit_status] {
    std::vector<std::string> ros_options;
    for (const CLI::Option* const option : command->get_options()) {
      if (option->get_name().starts_with("--ros-") && option->count() > 0) ros_options.push_back(option->get_name());
      if (option->get_name() == "--speed") options->has_speed = option->count() > 0;
      if (option->get_name() == "--ros-cmd-vel") options->has_commands = option->count() > 0;
    }
    exit_status = LoopbackCommand(*options, ros_options);
  });
}

}  // namespace troupe
