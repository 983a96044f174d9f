// Reporter: an observer that reports the progress of a run to people or to a launcher.
//
// Two forms of the same reports: lines on standard error for a service that was started by hand, JSON lines on a pipe
// for a launcher, which shows them, starts agents and prints the summary. Calls come on the thread of RunService,
// without the lock of the run: a blocked terminal delays reports, not ticks. Texts may contain words of peers; they are
// printed as plain text, without control characters.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "troupe/result.h"
#include "world-service/service/run_observer.h"
#include "world-service/service/run_service.h"

namespace troupe {

// How agents find a service and know it from others.
struct ServiceContact {
  std::vector<ServiceParticipant> participants;  // by group of agents; empty: not known
};

class Reporter : public RunObserver {
 public:
  // The world is loaded, and agents may join.
  virtual void Ready(const WorldDescription& world, const RunSettings& settings, const ServiceContact& contact) = 0;
  virtual void Ended(const RunSummary& summary) = 0;
  virtual void Failed(const Error& error) = 0;
};

// A launcher's news of the agents, on standard input: JSON objects, one a line. docs/tick-protocol.md has their fields.
// Nothing for a line that is none.
std::optional<AgentNews> ParseAgentNews(const std::string& line);

// Lines on standard error.
std::unique_ptr<Reporter> MakeConsoleReporter();

// JSON objects, one a line, on a descriptor that stays open. docs/tick-protocol.md has their fields. It reads the news
// of the launcher, too.
std::unique_ptr<Reporter> MakeLauncherReporter(int descriptor);

}  // namespace troupe
