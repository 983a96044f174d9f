// The figures of a run for a scraper, in the text format of Prometheus (version 0.0.4): one line for each figure, with
// its meaning.
//
// A scrape must not wait for the run: figures are those of the newest status, and the slowest robot that of an answer
// to an earlier scrape. Names and units are a contract (docs/viewer.md): base units, counters end in _total.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "transport/protocol/messages.h"
#include "viewer/gateway/run_feed.h"

namespace troupe {

inline constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

// The robot whose agent needs the longest time from a frame to its answer.
struct SlowestRobot {
  std::string robot;
  std::string host;
  double answer_seconds = 0.0;  // wall time
};

// Nothing if no agent that is present has answered yet.
std::optional<SlowestRobot> SlowestOf(const std::vector<EntityReport>& entities);

// `slowest`: of a little earlier. A run that is not found, or whose status is not known yet, has `troupe_up 0` alone.
std::string MetricsText(const std::string& session, const FeedHead& head, const AgentLosses& losses,
                        const std::optional<SlowestRobot>& slowest);

}  // namespace troupe
