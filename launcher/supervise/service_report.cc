#include "launcher/supervise/service_report.h"

#include <charconv>
#include <concepts>
#include <nlohmann/json.hpp>

#include "common/base/json_integer.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

// Reads a field if it exists; throws std::exception if it is of another type or out of range.
template <typename T>
void Get(const Json& object, const char* name, T& value) {
  const auto found = object.find(name);
  if (found == object.end()) return;
  if constexpr (std::integral<T> && !std::same_as<T, bool>) {
    value = IntegerOf<T>(*found);
  } else {
    found->get_to(value);
  }
}

// A hash is written as hexadecimal text: JSON numbers lose bits beyond 2^53.
void GetHash(const Json& object, const char* name, std::uint64_t& value) {
  std::string text;
  Get(object, name, text);
  std::from_chars(text.data(), text.data() + text.size(), value, 16);
}

ReadyReport ParseReady(const Json& json) {
  ReadyReport report;
  Get(json, "robots", report.robots);
  Get(json, "libraries", report.libraries);
  Get(json, "robots_per_process", report.robots_per_process);
  Get(json, "restart_agents", report.restart_agents);
  Get(json, "aborts_on_loss", report.aborts_on_loss);
  Get(json, "rebuilds_on_loss", report.rebuilds_on_loss);
  for (const Json& entry : json.value("participants", Json::array())) {
    ServiceParticipant& of_group = report.participants.emplace_back();
    Get(entry, "port", of_group.port);
    Get(entry, "participant", of_group.participant);
  }
  if (report.participants.empty()) report.participants.emplace_back();
  Get(json, "ros", report.ros);
  Get(json, "ros_infinite_ranges", report.ros_infinite_ranges);
  return report;
}

StatusMessage ParseStatus(const Json& json) {
  StatusMessage status;
  Get(json, "tick", status.tick);
  Get(json, "target_ticks", status.target_ticks);
  Get(json, "sim_seconds", status.sim_seconds);
  Get(json, "wall_seconds", status.wall_seconds);
  Get(json, "real_time_factor", status.real_time_factor);
  Get(json, "robots", status.robots);
  Get(json, "agents", status.agents);
  Get(json, "waiting_for", status.waiting_for);
  Get(json, "waiting_seconds", status.waiting_seconds);
  return status;
}

EventReport ParseEvent(const Json& json) {
  EventReport report;
  Get(json, "tick", report.tick);
  Get(json, "event", report.event);
  Get(json, "text", report.text);
  return report;
}

RunSummary ParseEnd(const Json& json) {
  RunSummary summary;
  Get(json, "ticks", summary.ticks);
  Get(json, "sim_seconds", summary.sim_seconds);
  Get(json, "wall_seconds", summary.wall_seconds);
  Get(json, "real_time_factor", summary.real_time_factor);
  Get(json, "startup_seconds", summary.startup_seconds);
  Get(json, "robots", summary.robots);
  Get(json, "stalls", summary.stalls);
  Get(json, "rejected", summary.rejected);
  Get(json, "frames_repeated", summary.frames_repeated);
  GetHash(json, "state_hash", summary.state_hash);
  for (const Json& entry : json.value("slowest", Json::array())) {
    SlowRobot slow;
    Get(entry, "robot", slow.robot);
    Get(entry, "times_last", slow.times_last);
    Get(entry, "waited_seconds", slow.waited_seconds);
    summary.slowest.push_back(slow);
  }
  Get(json, "lost", summary.lost);
  Get(json, "interrupted", summary.interrupted);
  Get(json, "record_waited_seconds", summary.record_waited_seconds);
  return summary;
}

std::optional<ServiceReport> Parse(const Json& json) {
  std::string type = json.value("type", "");
  if (type == "ready") return ParseReady(json);
  if (type == "robots") {
    NewRobotsReport report;
    Get(json, "robots", report.robots);
    Get(json, "edition", report.edition);
    return report;
  }
  if (type == "started") return StartedReport{};
  if (type == "status") return ParseStatus(json);
  if (type == "event" || type == "notice") return ParseEvent(json);
  if (type == "end") return ParseEnd(json);
  return std::nullopt;
}

}  // namespace

std::optional<ServiceReport> ParseServiceReport(const std::string& line) {
  try {
    return Parse(Json::parse(line));
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace troupe
