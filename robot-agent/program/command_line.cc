#include "robot-agent/program/command_line.h"

#include <CLI/CLI.hpp>

#include "common/base/version.h"
#include "common/command_line/option_checks.h"
#include "common/command_line/parse_command_line.h"
#include "common/command_line/trace_flags.h"

namespace troupe {
namespace {

CLI::Validator NotEmpty() {
  return CLI::Validator([](std::string& text) { return std::string(text.empty() ? "found nothing" : ""); }, "NAME");
}

void AddOptions(CLI::App& app, CommandLine& line, std::string& faults) {
  app.add_option("--session", line.session, "name of the run to join")->check(SessionName())->required();
  app.add_option("--robot", line.agent.robots, "a robot to take up; may be given several times")
      ->check(NotEmpty())
      ->required()
      ->allow_extra_args(false);
  app.add_option("--domain", line.domain, "DDS domain")->check(DdsDomain())->capture_default_str();
  app.add_option("--service", line.service_address, "where the world service is; default: this machine")
      ->type_name("HOST[:PORT]");
  app.add_option("--interface", line.network_interface,
                 "network interface or its address, or auto; default: lo, with --service auto")
      ->type_name("NAME");
  app.add_option("--network", line.network, "one-host, lan or unicast; default: by the interface")
      ->check(NetworkName())
      ->type_name("NAME");
  app.add_option("--lease", line.lease_seconds, "who is silent for longer is lost")
      ->check(PositiveNumber())
      ->capture_default_str();
  app.add_option("--scans", line.agent.scan_log, "write all scans of its robots, as JSON lines")->type_name("FILE");
  app.add_flag("--keep-scans", line.agent.keep_scan_log, "add to the file of --scans, for a robot started again");
  AddTraceFlags(app, line.agent.trace);
  app.add_option("--session-timeout", line.agent.session_timeout_seconds,
                 "for the world service to appear; 0: wait for ever")
      ->check(NumberFromZero())
      ->capture_default_str();
  AddRosFlags(app, line.ros, "ROS 2");
  app.add_option("--faults", faults, "for tests: lose, delay, double and reorder what arrives")
      ->type_name("SPEC")
      ->check(FaultsValue());
  app.add_option("--start-delay", line.start_delay_seconds, "for tests: wait before joining")->check(NumberFromZero());
  app.set_version_flag("--version", std::string("robot-agent ") + VersionText());
}

}  // namespace

std::variant<CommandLine, int> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  std::string faults;
  CLI::App app("Simulates robots of a run: their sensors, controllers and drives.", "robot-agent");
  AddOptions(app, line, faults);
  if (const std::optional<int> exit_status = ParseCommandLine(app, argc, argv)) return *exit_status;
  if (!faults.empty()) line.faults = ParseFaults(faults).value();
  if (line.network_interface.empty()) line.network_interface = line.service_address.empty() ? "lo" : "auto";
  return line;
}

}  // namespace troupe
