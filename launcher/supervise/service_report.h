// The reports of a world service to its launcher on the descriptor of --report-fd: one JSON object a line, with a
// "type".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/run/network_settings.h"
#include "transport/protocol/messages.h"
#include "world-service/service/run_summary.h"

namespace troupe {

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
  std::string event;  // as ToString(EventType); empty for a notice
  std::string text;   // one line
};

// "status" is a StatusMessage, "end" a RunSummary: their fields by name.
using ServiceReport = std::variant<ReadyReport, NewRobotsReport, StartedReport, StatusMessage, EventReport, RunSummary>;

// Nothing for any other line; also for an "error", which the service prints on standard error, too.
std::optional<ServiceReport> ParseServiceReport(const std::string& line);

}  // namespace troupe
