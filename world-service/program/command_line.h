// The command line of the program world-service.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "common/command_line/exit_status.h"
#include "common/command_line/ros_flags.h"
#include "common/protocol/faulty_transport.h"
#include "common/worldfile/load_world.h"
#include "world-service/service/run_service.h"

namespace troupe {

struct CommandLine {
  std::string file;
  LoadOverrides overrides;
  std::string session = "troupe";
  std::uint32_t domain = 42;
  std::string network_interface = "lo";
  std::string network;     // profile of common/dds/domain_config.h; empty: by the interface
  ServiceOptions service;  // without the settings: those come from the world, and then from here
  RosFlags ros;
  std::optional<int> report_fd;
  Faults faults;

  // Nothing: what the scenario says.
  std::optional<std::uint64_t> ticks;
  std::optional<Mode> mode;
  std::optional<double> speed;
  bool speed_max = false;  // as fast as possible, whatever the scenario says
  std::optional<OnAgentLoss> on_agent_loss;

  void ApplyTo(RunSettings& settings) const;
};

// What to run, or the exit status of a program that has nothing to run: it has said why, or printed what was asked for.
std::variant<CommandLine, int> ParseCommandLine(int argc, const char* const* argv);

}  // namespace troupe
