// The reports of a run: from its service to the launcher, its progress on standard error, and its summary.
//
// A report is parsed field by field with defaults, and a line that is none is no error: the service may be of another
// build on another host, and prints of libraries may get into the pipe. Exit statuses: docs/running.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "command_line/parse_command_line.h"
#include "common/run/run_settings.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "world-service/service/run_service.h"

namespace troupe {

// The reports of a world service to its launcher on the descriptor of --report-fd: one JSON object a line, with a
// "type".

// "ready": the world is loaded, and agents can join.
struct ReadyReport {
  std::vector<std::string> robots;     // in id order
  std::vector<std::string> libraries;  // controllers of robots
  std::uint32_t robots_per_process = 1;
  std::uint32_t restart_agents = 0;
  bool aborts_on_loss = false;                   // the run ends when an agent is lost
  bool rebuilds_on_loss = false;                 // the run waits for an agent that is lost
  std::vector<ServiceParticipant> participants;  // of the service, by group of agents; at least one
  bool ros = false;                              // the run uses ROS 2
  bool ros_infinite_ranges = true;
};

// "robots": an edit has added robots that need agents.
struct NewRobotsReport {
  std::vector<std::string> robots;
  Edition edition = 0;  // that the edit made
};

// "started": all robots have joined.
struct StartedReport {};

// "event" or "notice": a line for the user.
struct EventReport {
  Tick tick = 0;
  std::string event;  // the name of the EventType; empty for a notice
  std::string text;   // one line
};

// "status" is a StatusMessage, "end" a RunSummary: their fields by name.
using ServiceReport = std::variant<ReadyReport, NewRobotsReport, StartedReport, StatusMessage, EventReport, RunSummary>;

// Nothing for any other line; also for an "error", which the service prints on standard error, too.
std::optional<ServiceReport> ParseServiceReport(const std::string& line);

// "tick 312/600, 31.2 s, 12.3 x real time, 3 s left, 100 robots, waiting for r3, r4 (1.2 s)"
std::string StatusText(const StatusMessage& status);

// "r0, r1 and 8 more": at most ten of the names.
std::string ListText(const std::vector<std::string>& names);

// Progress: shows the progress of a run on standard error: a status line on a terminal, otherwise a line every five
// seconds.
class Progress {
 public:
  Progress();
  ~Progress();  // removes the status line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Update(const StatusMessage& status);
  // Prints an event, by its name (troupe/event.h). Omits stalls and the joins before the first tick, which are
  // too many.
  void TellEvent(Tick tick, const std::string& event, const std::string& text);
  // Prints a permanent line, and below it another one that can be copied.
  void Tell(const std::string& line, const std::string& command = "");
  // The same for one of the lines that a loss of many processes causes: of more than ten in a second, the others are
  // told as their number.
  void TellOneOfMany(const std::string& line, const std::string& command = "");
  // A request to stop: removes the status line, and the ^C that the terminal has shown.
  void OnStopRequest();
  // The end of the run: removes the status line.
  void End();
  // Whether a user sees the lines and can end the run with Ctrl-C.
  static bool IsInteractive();

 private:
  void ClearStatusLine();
  // The number of lines that TellOneOfMany has left out, once their second is over. `ends`: now.
  void TellNumberOfOthers(bool ends);

  bool terminal_;
  bool has_styles_;
  std::string status_line_;  // shown now, terminal only
  bool has_lost_agent_ = false;
  std::size_t of_many_ = 0;  // lines of TellOneOfMany in the second
  std::chrono::steady_clock::time_point second_began_ = {};
  std::chrono::steady_clock::time_point next_line_;
};

// The end of a run, and its summary as text and as JSON. docs/running.md has the format.

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

struct SummaryTextOptions {
  bool with_stats = false;  // of processes, too
  bool has_styles = false;  // for a terminal
};

// Several lines, each with its end.
std::string SummaryText(const RunOutcome& outcome, const SummaryTextOptions& options);

// A JSON object over several lines, the last one without its end.
std::string SummaryJson(const RunOutcome& outcome);

// In one process or in many.
struct RunEnd {
  int exit_status = kExitDone;
  std::optional<RunOutcome> outcome;  // of a run that began and did not fail
  std::optional<Error> error;         // to be printed; a failed run without it: a child process has printed the error
};

// The exit status of a run that did not fail.
inline int ExitStatusOf(const RunSummary& run) {
  if (run.interrupted) return kExitInterrupted;
  return run.frozen > 0 ? kExitRobotsLost : kExitDone;
}

// Shows a run's end and writes its summary file; returns the exit status. Called once, before a viewer that stays open
// is stopped.
using ReportEnd = std::function<int(const RunEnd& end)>;

// The exit status follows from the error.
inline RunEnd FailedRun(Error error) {
  const int exit_status = ExitStatusOf(error);
  return {exit_status, std::nullopt, std::move(error)};
}

}  // namespace troupe
