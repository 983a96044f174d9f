// The options that describe a run, for the programs that share them: the launcher, the world service, agents and tools.
// Each option is declared once, with its help, and there is an inverse for those that one program passes on to another
// (RunArguments, TraceArguments): so the two cannot drift apart.
//
// The variables must outlive the parsing: CLI11 keeps references to them. An option that was not given leaves its
// variable as it was, which is how defaults and files come first and the command line last.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "common/trace/tick_trace.h"
#include "troupe/result.h"

namespace CLI {

class App;
class Option;

}  // namespace CLI

namespace troupe {

// FILE, required: a world; and --model-path DIR, repeatable, which is set at once, for this process and its children.
CLI::Option* AddWorldFile(CLI::App& app, std::string& file);

// --robot FILE[@X,Y[,HEADING]], repeatable
void AddRobotFilesFlag(CLI::App& app, std::vector<std::string>& robots, const std::string& group = "Options");

// --seed S
void AddSeedFlag(CLI::App& app, std::optional<std::uint64_t>& seed, const std::string& group = "Options");

// --controller NAME
void AddControllerFlag(CLI::App& app, std::optional<std::string>& controller, const std::string& group = "Options");

// --controller, repeatable, and --from-tick T: of a run that may continue from a recording.
struct BranchFlags {
  std::vector<std::string> controllers;
  std::optional<std::uint64_t> from_tick;
};
void AddBranchFlags(CLI::App& app, BranchFlags& flags, const std::string& group = "Options");
// Moves the controller of a run that does not begin with a recording to `controller`. The error is a flag that only a
// recording can have.
Status CheckBranchFlags(const std::string& file, BranchFlags& flags, std::optional<std::string>& controller);

// --allow-controllers PATH, repeatable
void AddAllowControllersFlag(CLI::App& app, std::vector<std::string>& paths, const std::string& group = "Options");

// --allow-files PATH, repeatable
void AddAllowFilesFlag(CLI::App& app, std::vector<std::string>& paths, const std::string& group = "Options");

// --ticks, --mode, --speed, --on-agent-loss
void AddRunFlags(CLI::App& app, RunOverrides& overrides, const std::string& group = "Options");

// The arguments that give another program of Troupe the same overrides, --ros or --no-ros included.
std::vector<std::string> RunArguments(const RunOverrides& overrides);

// --robots-per-process
void AddRobotsPerProcessFlag(CLI::App& app, std::optional<std::uint32_t>& robots, const std::string& group = "Options");

// --paused
void AddPausedFlag(CLI::App& app, bool& paused, const std::string& group = "Options");

// --threads N. `automatic`: the number without it, for the help text.
void AddThreadsFlag(CLI::App& app, std::optional<std::uint32_t>& threads, const std::string& automatic,
                    const std::string& group = "Options");

// --start-timeout SECONDS
void AddStartTimeoutFlag(CLI::App& app, double& seconds, const std::string& group = "Options");

// --hash-log, --poses: also written by a replay.
void AddHashLogFlag(CLI::App& app, std::string& hash_log, const std::string& group = "Options");
void AddPosesFlag(CLI::App& app, std::string& poses, const std::string& group = "Options");

// --record FILE, --keyframe-interval TICKS
void AddRecordFlags(CLI::App& app, std::string& record, std::uint64_t& keyframe_interval,
                    const std::string& group = "Options");

// --scans FILE
void AddScansFlag(CLI::App& app, std::string& scans, const std::string& group = "Options");

// --faults SPEC: for tests. `faults` is text for ParseFaults (transport/protocol/faulty_transport.h).
void AddFaultsFlag(CLI::App& app, std::string& faults);

// The options by which the processes of a run, and its tools, find each other. The defaults that the help texts state
// are the values of `settings` at the time of the call; `settings` must outlive the parsing.

// --session NAME, or the variable TROUPE_SESSION of the environment. Likewise --domain below and TROUPE_DOMAIN.
CLI::Option* AddSessionFlag(CLI::App& app, NetworkSettings& settings, const std::string& help,
                            const std::string& group = "Options");

// --service HOST[:PORT]
void AddServiceAddressFlag(CLI::App& app, NetworkSettings& settings, const std::string& help);

// For a process of a run: --domain, --interface, --network, --security, --data-sharing and --lease. `default_interface`
// and `security` (the meaning of "auto") are parts of help texts.
void AddProcessNetworkFlags(CLI::App& app, NetworkSettings& settings, const std::string& default_interface,
                            const std::string& security, const std::string& group = "Options");

// For a tool that observes or controls runs: --domain, --interface, --service and --security.
void AddToolNetworkFlags(CLI::App& app, NetworkSettings& settings);

// The options --trace and --trace-ticks of the programs that work on ticks.

// `trace` must outlive the parsing.
void AddTraceFlags(CLI::App& app, TraceOptions& trace, const std::string& group = "Options");

// The arguments that give another program of Troupe the same options with `file` as its trace.
std::vector<std::string> TraceArguments(const TraceOptions& trace, const std::string& file);

}  // namespace troupe
