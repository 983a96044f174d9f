#include "world-service/program/command_line.h"

#include <CLI/CLI.hpp>
#include <map>
#include <vector>

#include "common/base/version.h"
#include "common/command_line/option_checks.h"
#include "common/command_line/parse_command_line.h"
#include "common/command_line/trace_flags.h"

namespace troupe {
namespace {

// One of the words in `values`, to its value.
template <typename Value>
void AddChoice(CLI::App& app, const std::string& name, std::optional<Value>& target,
               const std::map<std::string, Value>& values, const std::string& description) {
  std::vector<std::string> words;
  for (const auto& [word, value] : values) words.push_back(word);
  app.add_option_function<std::string>(
         name, [&target, values](const std::string& word) { target = values.at(word); }, description)
      ->type_name("NAME")
      ->check(OneOf(words));
}

void AddOptions(CLI::App& app, CommandLine& line, std::string& speed, std::string& faults) {
  app.add_option("file", line.file, "a Stage world (.world), a scenario (.json) or a ROS map (.yaml)")->required();
  app.add_option("--ticks", line.ticks, "end after this many ticks; otherwise run until stopped")
      ->check(WholeNumber(0));
  app.add_option("--seed", line.overrides.seed, "seed of everything random")->check(WholeNumber(0));
  AddChoice<Mode>(app, "--mode", line.mode, {{"lockstep", Mode::kLockstep}, {"realtime", Mode::kRealtime}},
                  "lockstep waits for every robot; realtime does not, and is not repeatable");
  app.add_option("--speed", speed, "multiple of real time, or max")->check(SpeedValue());
  app.add_option("--controller", line.overrides.controller, "controller of robots that have none");
  app.add_option("--session", line.session, "name of the run; agents join by it")
      ->check(SessionName())
      ->capture_default_str();
  app.add_option("--domain", line.domain, "DDS domain")->check(DdsDomain())->capture_default_str();
  app.add_option("--interface", line.network_interface, "network interface or its address, or auto")
      ->capture_default_str();
  app.add_option("--network", line.network, "one-host, lan or unicast; default: by the interface")
      ->check(NetworkName())
      ->type_name("NAME");
  AddChoice<OnAgentLoss>(
      app, "--on-agent-loss", line.on_agent_loss,
      {{"freeze", OnAgentLoss::kFreeze}, {"pause", OnAgentLoss::kPause}, {"abort", OnAgentLoss::kAbort}},
      "what becomes of a robot whose agent is lost, and of the run");
  app.add_option("--hash-log", line.service.outputs.hash_log, "write the state hash of every tick");
  app.add_option("--poses", line.service.outputs.poses, "write all poses at every tick, as CSV");
  app.add_option("--record", line.service.outputs.record, "write states and events of every tick, as JSON lines");
  AddTraceFlags(app, line.service.trace);
  app.add_option("--lease", line.service.lease_seconds, "an agent that is silent for longer is lost")
      ->check(PositiveNumber())
      ->capture_default_str();
  app.add_option("--start-timeout", line.service.start_timeout_seconds, "for all robots to join; 0: wait for ever")
      ->check(NumberFromZero())
      ->capture_default_str();
  app.add_flag("--paused", line.service.start_paused, "begin with a pause, until troupe ctl or ROS says otherwise");
  AddRosFlags(app, line.ros, "ROS 2");
  app.add_option("--faults", faults, "for tests: lose, delay, double and reorder what arrives")->check(FaultsValue());
  app.add_option("--report-fd", line.report_fd, "descriptor to report to, as JSON lines, for a launcher")
      ->check(WholeNumber(0, 1 << 20));
  app.set_version_flag("--version", std::string("world-service ") + VersionText());
}

}  // namespace

void CommandLine::ApplyTo(RunSettings& settings) const {
  if (ticks) settings.ticks = ticks;
  if (mode) settings.mode = *mode;
  if (speed || speed_max) settings.speed = speed;
  if (on_agent_loss) settings.on_agent_loss = *on_agent_loss;
  if (ros.on) settings.ros = *ros.on;
}

std::variant<CommandLine, int> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  std::string speed;
  std::string faults;
  CLI::App app("Runs a world: waits for the agents of its robots, and decides what happens at each tick.",
               "world-service");
  AddOptions(app, line, speed, faults);
  if (const std::optional<int> exit_status = ParseCommandLine(app, argc, argv)) return *exit_status;
  line.speed_max = speed == "max";
  if (!line.speed_max && !speed.empty()) line.speed = std::stod(speed);
  line.faults = ParseFaults(faults).value();
  line.service.session = line.session;
  return line;
}

}  // namespace troupe
