#include "launcher/run_options.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "common/command_line/option_checks.h"
#include "common/worldfile/scenario.h"

namespace troupe {
namespace {

using NamedFile = std::pair<const char*, const std::string*>;

std::vector<NamedFile> OutputsOf(const RunOptions& options) {
  return {{"--hash-log", &options.hash_log}, {"--poses", &options.poses},   {"--scans", &options.scans},
          {"--summary", &options.summary},   {"--record", &options.record}, {"--trace", &options.trace}};
}

Status CheckWritable(const NamedFile& output) {
  int file = open(output.second->c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) {
    return Error{{}, std::string(output.first) + ": cannot write " + *output.second + ": " + strerror(errno)};
  }
  close(file);
  return std::nullopt;
}

// Two files written at once to one path would be mixed up. A device takes anything.
Status CheckDistinct(const std::vector<NamedFile>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = i + 1; j < outputs.size(); ++j) {
      const std::string& path = *outputs[i].second;
      if (path != *outputs[j].second) continue;
      if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path)) continue;
      return Error{{}, std::string(outputs[i].first) + " and " + outputs[j].first + " name the same file, " + path};
    }
  }
  return std::nullopt;
}

Status CheckOutputs(const RunOptions& options) {
  std::vector<NamedFile> outputs = OutputsOf(options);
  std::erase_if(outputs, [](const NamedFile& output) { return output.second->empty(); });
  if (Status failure = CheckDistinct(outputs)) return failure;
  for (const NamedFile& output : outputs) {
    if (Status failure = CheckWritable(output)) return failure;
  }
  return std::nullopt;
}

// "<world>-<pid>", with what a session's name cannot hold left out.
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

template <typename T>
void Append(std::vector<std::string>& arguments, const char* option, const std::optional<T>& value) {
  if (value) Append(arguments, option, std::to_string(*value));
}

void AppendConnection(std::vector<std::string>& arguments, const RunOptions& options) {
  Append(arguments, "--session", options.session);
  Append(arguments, "--domain", std::to_string(options.domain));
  Append(arguments, "--interface", options.network_interface);
  Append(arguments, "--network", options.network);
  Append(arguments, "--lease", CLI::detail::to_string(options.lease_seconds));
  Append(arguments, "--faults", options.faults);
}

}  // namespace

void AddRunOptions(CLI::App& command, RunOptions& options) {
  command.add_option("FILE", options.file, "A Stage .world file, a JSON scenario or a ROS map .yaml")->required();

  const char* simulation = "Simulation (what is not given is as the scenario says)";
  auto add = [&command](const char* group, const char* name, auto& value, const char* help) {
    return command.add_option(name, value, help)->group(group);
  };
  add(simulation, "--ticks", options.ticks, "Stop after N ticks; without it: run until Ctrl-C")
      ->check(WholeNumber(1))
      ->type_name("N");
  add(simulation, "--seed", options.seed, "Seed of all random numbers")->check(WholeNumber(0))->type_name("S");
  add(simulation, "--mode", options.mode,
      "lockstep: wait for every robot at every tick, repeatable; realtime: do not wait for late robots")
      ->check(OneOf({"lockstep", "realtime"}))
      ->type_name("MODE");
  add(simulation, "--speed", options.speed, "Multiple of real time, or max for as fast as possible")
      ->check(SpeedValue())
      ->type_name("X|max");
  add(simulation, "--controller", options.controller,
      "Controller of the robots that the file gives none: idle, wander, expand, or a library's path")
      ->type_name("NAME");
  command.add_flag("--paused", options.paused, "Begin with a pause, until troupe ctl or ROS 2 says otherwise")
      ->group(simulation);
  add(simulation, "--on-agent-loss", options.on_agent_loss,
      "When a robot's process is lost: freeze the robot, pause the run until it is back, or abort")
      ->check(OneOf({"freeze", "pause", "abort"}))
      ->type_name("POLICY");

  const char* processes = "Processes and network";
  command.add_flag("--in-process", options.in_process, "Run everything in this process, without DDS")->group(processes);
  add(processes, "--robots-per-process", options.robots_per_process, "Robots in one agent process (default: 1)")
      ->check(WholeNumber(1, 100000))
      ->type_name("K");
  add(processes, "--session", options.session,
      "Name of the run on the network (default: the world's name and this process's id)")
      ->check(SessionName())
      ->type_name("NAME");
  add(processes, "--domain", options.domain, "DDS domain of the simulation (default: 42)")
      ->check(DdsDomain())
      ->type_name("D");
  add(processes, "--interface", options.network_interface,
      "Network interface or its address, or auto (default: lo, this machine only; auto if the scenario has hosts)")
      ->type_name("NAME");
  add(processes, "--network", options.network,
      "one-host, lan (with multicast) or unicast (default: as the scenario says, or by the interface)")
      ->check(NetworkName())
      ->type_name("NAME");
  add(processes, "--lease", options.lease_seconds, "Seconds of silence after which a process is lost (default: 2)")
      ->check(PositiveNumber())
      ->type_name("SECONDS");
  add(processes, "--start-timeout", options.start_timeout_seconds,
      "Seconds for all robots to come; 0: for ever (default: 60)")
      ->check(NumberFromZero())
      ->type_name("SECONDS");
  command.add_flag("--headless", options.headless, "Open no viewer")->group(processes);

  AddRosFlags(command, options.ros, "ROS 2");

  const char* outputs = "Output files";
  add(outputs, "--hash-log", options.hash_log, "A line 'tick hash' for each tick")->type_name("FILE");
  add(outputs, "--poses", options.poses, "CSV: tick,robot,x,y,z,heading,stalled")->type_name("FILE");
  add(outputs, "--scans", options.scans, "JSON lines: tick, robot, sensor, ranges")->type_name("FILE");
  add(outputs, "--summary", options.summary, "The run's summary as a JSON object")->type_name("FILE");
  add(outputs, "--record", options.record, "The whole run as JSON lines")->type_name("FILE");
  add(outputs, "--trace", options.trace, "What each process did when, for chrome://tracing or ui.perfetto.dev")
      ->type_name("FILE");
  add(outputs, "--trace-ticks", options.trace_ticks, "Which ticks --trace is for (default: all)")
      ->check(TraceTicksValue())
      ->type_name("FIRST:LAST");

  const char* testing = "Testing";
  add(testing, "--faults", options.faults,
      "Make the network worse: loss=P,duplicate=P,reorder=P,delay=P:SECONDS,seed=N")
      ->check(FaultsValue())
      ->type_name("SPEC");
  add(testing, "--shuffle-start", options.shuffle_start, "Start the agents in another order, each after a random delay")
      ->check(WholeNumber(0))
      ->type_name("SEED");
}

Status CompleteRunOptions(RunOptions& options) {
  if (options.session.empty()) options.session = OwnSession(options.file);
  if (!options.in_process && options.file.ends_with(".json")) {
    Result<HostsOfScenario> hosts = ReadHostsOfScenario(options.file);
    if (!hosts.ok()) return hosts.error();
    options.hosts = std::move(hosts.value().hosts);
    if (options.network.empty()) options.network = hosts.value().network;
  }
  if (options.network_interface.empty()) options.network_interface = options.hosts.empty() ? "lo" : "auto";
  return CheckOutputs(options);
}

std::string InterfaceOf(const HostSettings& host) {
  if (!host.network_interface.empty()) return host.network_interface;
  in_addr address{};
  return inet_pton(AF_INET, host.address.c_str(), &address) == 1 ? host.address : "auto";
}

void ApplyTo(RunSettings& settings, const RunOptions& options) {
  if (options.ticks) settings.ticks = options.ticks;
  if (!options.mode.empty()) settings.mode = options.mode == "realtime" ? Mode::kRealtime : Mode::kLockstep;
  if (options.speed == "max") {
    settings.speed.reset();
  } else if (!options.speed.empty()) {
    settings.speed = std::stod(options.speed);
  }
  if (options.on_agent_loss == "freeze") settings.on_agent_loss = OnAgentLoss::kFreeze;
  if (options.on_agent_loss == "pause") settings.on_agent_loss = OnAgentLoss::kPause;
  if (options.on_agent_loss == "abort") settings.on_agent_loss = OnAgentLoss::kAbort;
  if (options.ros.on) settings.ros = *options.ros.on;
}

std::vector<std::string> ServiceArguments(const RunOptions& options) {
  std::vector<std::string> arguments = {options.file};
  Append(arguments, "--ticks", options.ticks);
  Append(arguments, "--seed", options.seed);
  Append(arguments, "--mode", options.mode);
  Append(arguments, "--speed", options.speed);
  Append(arguments, "--controller", options.controller);
  Append(arguments, "--on-agent-loss", options.on_agent_loss);
  AppendConnection(arguments, options);
  Append(arguments, "--start-timeout", CLI::detail::to_string(options.start_timeout_seconds));
  Append(arguments, "--hash-log", options.hash_log);
  Append(arguments, "--poses", options.poses);
  Append(arguments, "--record", options.record);
  Append(arguments, "--trace", options.trace);
  if (!options.trace.empty()) Append(arguments, "--trace-ticks", options.trace_ticks);
  if (options.paused) arguments.emplace_back("--paused");
  if (options.ros.on) arguments.emplace_back(*options.ros.on ? "--ros" : "--no-ros");
  for (std::string& argument : RosArguments(options.ros.options)) arguments.push_back(std::move(argument));
  return arguments;
}

std::vector<std::string> AgentArguments(const RunOptions& options, const std::string& service_address,
                                        const std::vector<std::string>& robots, bool ros) {
  std::vector<std::string> arguments;
  AppendConnection(arguments, options);
  Append(arguments, "--service", service_address);
  for (const std::string& robot : robots) Append(arguments, "--robot", robot);
  if (!ros) return arguments;
  arguments.emplace_back("--ros");
  for (std::string& argument : RosArguments(options.ros.options)) arguments.push_back(std::move(argument));
  return arguments;
}

}  // namespace troupe
