// RunOptions: the options of `troupe run`.
//
// One struct for both ways of running; which options exclude each other is in command_line/exclusive_options.cc, so
// that nothing later has to consider a combination without meaning. ServiceArguments and AgentArguments are the only
// places that know the command lines of the two programs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "command_line/run_flags.h"
#include "common/run/run_settings.h"
#include "common/trace/tick_trace.h"
#include "ros/messages/ros_options.h"
#include "troupe/result.h"
#include "world-service/program/fleet_flags.h"
#include "world-service/service/requested_file.h"
#include "worldfile/load_world.h"

namespace CLI {
class App;
}

namespace troupe {

struct RunOptions {
  // A world, a scenario or a recording to be continued.
  std::string file;
  RunOverrides run;     // of the scenario's settings
  LoadOverrides load;   // of its seed, controllers and problem of paths
  std::string planner;  // a command that plans the paths of a problem; empty: none
  BranchFlags branch;   // of a recording
  OwnerPermissions permissions;

  bool in_process = false;
  std::optional<std::uint32_t> threads;         // nothing: in one process all cores, else one
  std::optional<std::uint32_t> restart_agents;  // as above
  OnServiceLoss on_service_loss = OnServiceLoss::kRestart;
  std::string journal;                      // file; empty: without a name, for this run alone
  bool journal_sync = false;                // it survives a loss of power
  NetworkSettings network;                  // session or interface empty: CompleteRunOptions chooses one
  std::vector<std::string> host_addresses;  // in place of the scenario's hosts; empty: those
  std::string host_start;                   // HostSettings::start of these
  std::vector<HostSettings> hosts;          // none: this host only
  double start_timeout_seconds = kDefaultStartTimeoutSeconds;
  bool paused = false;    // at the start
  bool headless = false;  // no viewer
  ros::RosOptions ros = ros::OptionsFromEnvironment();
  FleetOptions fleet;  // "local": a broker of the run

  // Files; empty: none.
  std::string hash_log;
  std::string poses;
  std::string scans;
  std::string summary;
  bool stats = false;  // the summary on the terminal is of processes, too
  std::string record;
  std::uint64_t keyframe_interval = kDefaultKeyframeInterval;  // of the record, if it is a recording
  TraceOptions trace;

  // For tests.
  std::string faults;  // text for ParseFaults (transport/protocol/faulty_transport.h)
  std::optional<std::uint64_t> shuffle_start;
};

// Declares the options, with the checks that need only their text. `options` must outlive the parsing.
void AddRunOptions(CLI::App& command, RunOptions& options);

// Determines the hosts, by the options or the scenario; chooses a session name and a network interface unless the
// options have them.
Status CompleteRunOptions(RunOptions& options);

// The arguments of the program world-service for this run, without the report's descriptor and its journal.
std::vector<std::string> ServiceArguments(const RunOptions& options);

// The arguments of the program robot-agent for these robots, without its output files. `service_address` is
// "host:port"; `libraries` are the controllers of the run's own file; `ros`: the run uses ROS 2.
std::vector<std::string> AgentArguments(const RunOptions& options, const std::string& service_address,
                                        const std::vector<std::string>& robots,
                                        const std::vector<std::string>& libraries, bool ros);

// The network interface for processes on a host.
std::string InterfaceOf(const HostSettings& host);

}  // namespace troupe
