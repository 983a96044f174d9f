// What `troupe run` was asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/command_line/ros_flags.h"
#include "common/worldfile/host_settings.h"
#include "common/worldfile/load_world.h"

namespace CLI {
class App;
}

namespace troupe {

struct RunOptions {
  std::string file;

  // Nothing or empty: what the scenario says, or the default.
  std::optional<std::uint64_t> ticks;
  std::optional<std::uint64_t> seed;
  std::string mode;
  std::string speed;  // a multiple of real time, or "max"
  std::string controller;
  std::string on_agent_loss;
  std::optional<std::uint32_t> robots_per_process;

  bool in_process = false;
  std::string session;  // empty: one of its own
  std::uint32_t domain = 42;
  std::string network_interface;    // name or address, or "auto"; empty: "lo", with hosts "auto"
  std::string network;              // profile of common/dds/domain_config.h; empty: by the interface
  std::vector<HostSettings> hosts;  // of the scenario; none: this machine only
  double lease_seconds = 2.0;
  double start_timeout_seconds = 60.0;
  bool paused = false;  // at the start
  RosFlags ros;
  bool headless = false;  // no viewer exists yet: every run is headless

  std::string hash_log;
  std::string poses;
  std::string scans;
  std::string summary;
  std::string record;
  std::string trace;
  std::string trace_ticks;  // which of them, as "100:120"; empty: all

  // For tests.
  std::string faults;  // see common/protocol/faulty_transport.h
  std::optional<std::uint64_t> shuffle_start;
};

// Declares the options, with the checks that need only their text.
void AddRunOptions(CLI::App& command, RunOptions& options);

// Checks what involves more: output files that cannot be written, options that are not part of this build. Reads the
// hosts of a scenario, and gives the run a session name and a network interface if it has none.
Status CompleteRunOptions(RunOptions& options);

// Overrides a scenario's settings with the options that were given.
void ApplyTo(RunSettings& settings, const RunOptions& options);

// The arguments of the program world-service for this run, without the report's descriptor.
std::vector<std::string> ServiceArguments(const RunOptions& options);

// The arguments of the program robot-agent for the robots named. `service_address` is "host:port"; `ros`: the run shows
// its robots to ROS 2.
std::vector<std::string> AgentArguments(const RunOptions& options, const std::string& service_address,
                                        const std::vector<std::string>& robots, bool ros);

// The network interface for processes on a host.
std::string InterfaceOf(const HostSettings& host);

}  // namespace troupe
