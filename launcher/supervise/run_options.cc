#include "launcher/supervise/run_options.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>

#include "command_line/parse_command_line.h"
#include "recording/recording.h"
#include "robot-agent/agent/agent_host.h"
#include "ros/flags/ros_flags.h"
#include "ros/link/host_program.h"
#include "world-service/program/fleet_flags.h"
#include "world-service/program/grid_flags.h"
#include "worldfile/scenario/scenario.h"

namespace troupe {
namespace {

// "<world>-<pid>", without the characters that a session name cannot contain.
std::string OwnSession(const std::string& file) {
  std::string name;
  for (char c : std::filesystem::path(file).stem().string()) {
    bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
    if (plain && name.size() < 40) name += c;
  }
  return (name.empty() ? "world" : name) + "-" + std::to_string(getpid());
}

void Append(std::vector<std::string>& arguments, const char* option, const std::string& value) {
  if (!value.empty()) arguments.push_back(std::string(option) + "=" + value);
}

void Append(std::vector<std::string>& arguments, std::vector<std::string> more) {
  for (std::string& argument : more) arguments.push_back(std::move(argument));
}

// All processes of a run need the same values here: another domain or profile would let them not find each other.
std::vector<std::string> NetworkArguments(const RunOptions& options) {
  const NetworkSettings& network = options.network;
  std::vector<std::string> arguments;
  Append(arguments, "--session", network.session);
  Append(arguments, "--domain", std::to_string(network.domain));
  Append(arguments, "--interface", network.network_interface);
  Append(arguments, "--network", network.network_profile);
  if (network.lease_seconds) Append(arguments, "--lease", fmt::format("{}", *network.lease_seconds));
  Append(arguments, "--security", network.security);
  if (!network.data_sharing) arguments.emplace_back("--data-sharing=off");
  Append(arguments, "--faults", options.faults);
  return arguments;
}

// Without the command the shell line would start nothing on the host, and the run would wait for it.
std::string CheckHostStart(const std::string& text) {
  if (text.find("{command") != std::string::npos) return "";
  return "found no '{command}' in '" + text + "', expected one, or '{command_text}'";
}

// What a run does after the death of its world service.
void AddServiceLossFlags(CLI::App& command, RunOptions& options, const char* group) {
  command
      .add_option_function<std::string>(
          "--on-service-loss",
          [&options](const std::string& word) { options.on_service_loss = *FindByName<OnServiceLoss>(word); },
          "When the world service dies: restart it, so that the run continues (default), or end the run")
      ->check(OneOf(AllNames<OnServiceLoss>()))
      ->type_name("POLICY")
      ->group(group);
  command
      .add_option("--journal", options.journal,
                  "Keep the journal from which a world service that has died is restarted: a recording (default: the "
                  "file of --record FILE.mcap, or a file without a name that ends with the run)")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group(group);
  command
      .add_flag("--journal-sync", options.journal_sync,
                "Wait in each tick until the journal is on the disk, so that it survives a loss of power")
      ->group(group);
}

void AddHostFlags(CLI::App& command, RunOptions& options, const char* group) {
  CLI::Option* const hosts =
      command
          .add_option("--hosts", options.host_addresses,
                      "Hosts of the robots, in place of the scenario's; the world service is here")
          ->delimiter(',')
          ->check(NotEmpty())
          ->type_name("NAME,...")
          ->allow_extra_args(false)  // which would be FILE
          ->group(group);
  command
      .add_option("--host-start", options.host_start,
                  "Shell command that starts a process on one of --hosts, with {address} and {command} or "
                  "{command_text} in it (default: by ssh)")
      ->check(CLI::Validator(CheckHostStart, ""))
      ->type_name("COMMAND")
      ->needs(hosts)
      ->group(group);
}

// Defaults are decided later, by CompleteRunOptions: they depend on the scenario's hosts.
void AddProcessFlags(CLI::App& command, RunOptions& options) {
  const char* group = "Processes and network";
  command.add_flag("--in-process", options.in_process, "Run service and agents in this process, without DDS")
      ->group(group);
  AddRobotsPerProcessFlag(command, options.run.robots_per_process, group);
  command
      .add_option("--restart-agents", options.restart_agents,
                  fmt::format("Start each agent that dies again, up to N times; 0: never (default: the scenario's, or "
                              "{})",
                              kDefaultRestartAgents))
      ->check(WholeNumber(0, kMaxRestartAgents))
      ->type_name("N")
      ->group(group);
  AddServiceLossFlags(command, options, group);
  AddHostFlags(command, options, group);
  AddThreadsFlag(command, options.threads, "with --in-process all cores; otherwise 1, of the world service", group);
  AddSessionFlag(command, options.network,
                 "Name of the run on the network (default: the world's name and the process id)", group);
  options.network.network_interface.clear();  // CompleteRunOptions chooses
  AddProcessNetworkFlags(command, options.network, "lo: this host only; auto if the scenario has hosts",
                         "on, keys for this run alone; on the interface lo a token of the run", group);
  AddStartTimeoutFlag(command, options.start_timeout_seconds, group);
  command.add_flag("--headless", options.headless, "Start no viewer (see 'troupe view')")->group(group);
}

void AddOutputFlags(CLI::App& command, RunOptions& options) {
  const char* group = "Output files";
  AddHashLogFlag(command, options.hash_log, group);
  AddPosesFlag(command, options.poses, group);
  AddRecordFlags(command, options.record, options.keyframe_interval, group);
  AddScansFlag(command, options.scans, group);
  command.add_option("--summary", options.summary, "Write the summary of the run as a JSON object")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group(group);
  command
      .add_flag("--stats", options.stats, "End with figures of the processes, too: start, memory, the slowest robots")
      ->group(group);
  AddTraceFlags(command, options.trace, group);
}

}  // namespace

void AddRunOptions(CLI::App& command, RunOptions& options) {
  AddWorldFile(command, options.file);

  const char* simulation = "Simulation";
  AddRunFlags(command, options.run, simulation);
  AddSeedFlag(command, options.load.seed, simulation);
  AddRobotFilesFlag(command, options.load.robots, simulation);
  AddGridFlags(command, options.load.grid, simulation);
  command
      .add_option("--planner", options.planner,
                  "With a problem of paths: a shell command that reads the problem (JSON) and writes the paths, which "
                  "go to the file of --paths, if it is given")
      ->check(NotEmpty())
      ->type_name("COMMAND")
      ->group(simulation);
  AddBranchFlags(command, options.branch, simulation);
  AddPausedFlag(command, options.paused, simulation);

  const char* requests = "Requests during the run";
  AddAllowFilesFlag(command, options.permissions.files, requests);
  AddAllowControllersFlag(command, options.permissions.controllers, requests);

  AddProcessFlags(command, options);

  const char* ros = "ROS 2";
  AddRosFlags(command, options.run.ros, options.ros, ros);
  AddRobotTopicFlags(command, options.ros.robots, ros);
  AddBuildingMapFlag(command, options.ros.world, ros);
  AddWorldTopicFlags(command, options.ros.world, ros);
  AddPoseTopicFlags(command, options.ros.pose_topics, ros);
  AddLockstepFlags(command, options.ros.lockstep, ros);
  command.add_option("--ros-participants", "Without effect: the processes of a host share the program ros-participant")
      ->check(OneOf({"process", "host"}))
      ->type_name("NAME")
      ->group(ros);
  AddFleetFlags(command, options.fleet,
                "Connect the robots with the controller vda5050 to a fleet control through an MQTT broker: "
                "mqtt://HOST[:PORT] or mqtts://HOST[:PORT]; local: the run starts one on the loopback interface");
  AddOutputFlags(command, options);

  AddFaultsFlag(command, options.faults);
  command
      .add_option("--shuffle-start", options.shuffle_start,
                  "Start the agents in a random order, each after a random delay")
      ->check(WholeNumber(0))
      ->type_name("SEED")
      ->group("Testing");
  FindOption(command, "--trace-ticks").needs(&FindOption(command, "--trace"));
}

// In this order: hosts, then the interface, whose default depends on them.
Status CompleteRunOptions(RunOptions& options) {
  NetworkSettings& network = options.network;
  if (Status problem = CheckBranchFlags(options.file, options.branch, options.load.controller); !problem.ok()) {
    return problem;
  }
  if (options.in_process && options.keyframe_interval != kDefaultKeyframeInterval && !IsRecordingPath(options.record)) {
    return Error{{}, "--keyframe-interval: found no recording, expected --record FILE.mcap beside --in-process"};
  }
  if (network.session.empty()) network.session = OwnSession(options.file);
  options.run.is_watched = !options.headless;
  if (!options.in_process && options.file.ends_with(".json")) {
    Result<HostsOfScenario> hosts = ReadHostsOfScenario(options.file);
    if (!hosts.ok()) return hosts.error();
    options.hosts = std::move(hosts.value().hosts);
    if (network.network_profile.empty()) network.network_profile = hosts.value().network;
  }
  if (!options.in_process && !options.host_addresses.empty()) options.hosts.clear();
  for (const std::string& address : options.in_process ? std::vector<std::string>() : options.host_addresses) {
    for (const HostSettings& other : options.hosts) {
      if (other.address == address)
        return Error{{}, "option --hosts: found '" + address + "' twice, expected each host once"};
    }
    HostSettings& host = options.hosts.emplace_back();
    host.name = host.address = address;
    host.start = options.host_start;
  }
  // With security each process starts a program of its own, with its keys.
  const bool is_secured = options.ros.network.security.strategy != ros::SecurityStrategy::kOff;
  if ((options.in_process || !is_secured) && options.ros.socket.empty()) options.ros.socket = ros::NewSocketName();
  if (network.network_interface.empty()) {
    network.network_interface = options.hosts.empty() ? kLoopbackInterface : kAutomaticInterface;
  }
  return Status();
}

// An address of the host names the interface that has it. A name would have to be resolved on that host, so DDS
// chooses.
std::string InterfaceOf(const HostSettings& host) {
  if (!host.network_interface.empty()) return host.network_interface;
  in_addr address{};
  return inet_pton(AF_INET, host.address.c_str(), &address) == 1 ? host.address : kAutomaticInterface;
}

// "--option=value" in one word, so that a value that begins with a dash stays a value.
std::vector<std::string> ServiceArguments(const RunOptions& options) {
  std::vector<std::string> arguments;
  if (!options.file.empty()) arguments.push_back(options.file);
  Append(arguments, RunArguments(options.run));
  if (options.load.seed) Append(arguments, "--seed", std::to_string(*options.load.seed));
  for (const std::string& robot : options.load.robots) Append(arguments, "--robot", robot);
  Append(arguments, GridArguments(options.load.grid));
  if (options.load.controller) Append(arguments, "--controller", *options.load.controller);
  for (const std::string& controller : options.branch.controllers) Append(arguments, "--controller", controller);
  if (options.branch.from_tick) Append(arguments, "--from-tick", std::to_string(*options.branch.from_tick));
  Append(arguments, NetworkArguments(options));
  for (const std::string& path : options.permissions.files) Append(arguments, "--allow-files", path);
  for (const std::string& path : options.permissions.controllers) Append(arguments, "--allow-controllers", path);
  Append(arguments, "--start-timeout", fmt::format("{}", options.start_timeout_seconds));
  Append(arguments, "--hash-log", options.hash_log);
  Append(arguments, "--poses", options.poses);
  Append(arguments, "--record", options.record);
  Append(arguments, "--keyframe-interval", std::to_string(options.keyframe_interval));
  if (!options.trace.file.empty()) Append(arguments, TraceArguments(options.trace, options.trace.file));
  if (options.paused) arguments.emplace_back("--paused");
  if (options.threads) Append(arguments, "--threads", std::to_string(*options.threads));
  Append(arguments, ServiceRosArguments(options.ros));
  Append(arguments, FleetArguments(options.fleet));
  return arguments;
}

std::vector<std::string> AgentArguments(const RunOptions& options, const std::string& service_address,
                                        const std::vector<std::string>& robots,
                                        const std::vector<std::string>& libraries, bool ros) {
  std::vector<std::string> arguments = NetworkArguments(options);
  Append(arguments, "--service", service_address);
  Append(arguments, "--service-participant", options.network.service_participant);
  // An agent that looks for the service must not give up before the service gives up the agent.
  const double start_timeout = options.start_timeout_seconds;
  if (start_timeout == 0.0 || start_timeout > AgentOptions().session_timeout_seconds) {
    Append(arguments, "--session-timeout", fmt::format("{}", start_timeout));
  }
  for (const std::string& robot : robots) Append(arguments, "--robot", robot);
  for (const std::string& library : libraries) Append(arguments, "--allow-controllers", library);
  // A robot that is spawned later may be the first with the controller of the command line.
  const std::string controller = options.load.controller.value_or("");
  if (NamesLibrary(controller)) Append(arguments, "--allow-controllers", ControllerFile(controller));
  for (const std::string& path : options.permissions.controllers) Append(arguments, "--allow-controllers", path);
  if (!ros) return arguments;
  arguments.emplace_back("--ros");
  Append(arguments, AgentRosArguments(options.ros));
  return arguments;
}

}  // namespace troupe
