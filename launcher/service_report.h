// What a world service tells its launcher on the descriptor of --report-fd: a JSON object a line, told apart by "type".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/protocol/messages.h"
#include "world-service/service/run_summary.h"

namespace troupe {

// "ready": the world is loaded, agents may come.
struct ReadyReport {
  std::vector<std::string> robots;  // in id order
  std::uint32_t robots_per_process = 1;
  std::uint16_t port = 0;  // UDP, where agents find the service; 0: not known
  bool ros = false;        // the run shows its robots to ROS 2
};

// "robots": an edit of the world has brought robots that need agents.
struct NewRobotsReport {
  std::vector<std::string> robots;
};

// "started": all robots are there.
struct StartedReport {};

// "event" or "notice": something worth telling.
struct EventReport {
  Tick tick = 0;
  std::string event;  // as ToString(EventType); empty for a notice
  std::string text;   // one line for people
};

// "status" is a StatusMessage, "end" a RunSummary: their fields by name.
using ServiceReport = std::variant<ReadyReport, NewRobotsReport, StartedReport, StatusMessage, EventReport, RunSummary>;

// Nothing for a line that is none of these, as for "error": the service says that on standard error too.
std::optional<ServiceReport> ParseServiceReport(const std::string& line);

}  // namespace troupe
