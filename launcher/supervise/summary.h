// The end of a run, and its summary as text and as JSON. docs/running.md has the format.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command_line/exit_status.h"
#include "troupe/result.h"
#include "world-service/service/run_summary.h"

namespace troupe {

struct RunOutcome {
  RunSummary run;
  std::uint32_t processes = 1;               // service and agents
  std::uint32_t agents_restarted = 0;        // restarts of all agents
  std::uint32_t service_restarted = 0;       // restarts of the world service
  std::map<std::string, std::string> hosts;  // by robot; empty: all on this host
  std::vector<std::string> missing_files;    // what output files lack because hosts were lost
  double service_peak_memory_mib = 0.0;      // largest resident size; of the only process, if there is but one
  double agent_peak_memory_mib = 0.0;        // of the largest agent; 0: no agent had its own process
};

// Several lines, each with its end.
std::string SummaryText(const RunOutcome& outcome);

// A JSON object over several lines, the last one without its end.
std::string SummaryJson(const RunOutcome& outcome);

// In one process or in many.
struct RunEnd {
  int exit_status = kExitDone;
  std::optional<RunOutcome> outcome;  // of a run that began and did not fail
  std::optional<Error> error;         // to be printed; a failed run without it: a child process has printed the error
};

// The exit status follows from the error.
inline RunEnd FailedRun(Error error) {
  const int exit_status = ExitStatusOf(error);
  return {exit_status, std::nullopt, std::move(error)};
}

}  // namespace troupe
