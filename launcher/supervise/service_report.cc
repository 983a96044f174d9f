#include "launcher/supervise/service_report.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "common/base/json_fields.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

// A hash is written as hexadecimal text: JSON numbers lose bits beyond 2^53.
void ReadHash(const Json& object, const char* name, std::uint64_t& value) {
  std::string text;
  ReadMember(object, name, text);
  std::from_chars(text.data(), text.data() + text.size(), value, 16);
}

ReadyReport ParseReady(const Json& json) {
  ReadyReport report;
  ReadMember(json, "robots", report.robots);
  ReadMember(json, "libraries", report.libraries);
  ReadMember(json, "robots_per_process", report.robots_per_process);
  ReadMember(json, "restart_agents", report.restart_agents);
  ReadMember(json, "aborts_on_loss", report.aborts_on_loss);
  ReadMember(json, "rebuilds_on_loss", report.rebuilds_on_loss);
  for (const Json& entry : json.value("participants", Json::array())) {
    ServiceParticipant& of_group = report.participants.emplace_back();
    ReadMember(entry, "port", of_group.port);
    ReadMember(entry, "participant", of_group.participant);
  }
  if (report.participants.empty()) report.participants.emplace_back();
  ReadMember(json, "ros", report.ros);
  ReadMember(json, "ros_infinite_ranges", report.ros_infinite_ranges);
  return report;
}

EventReport ParseEvent(const Json& json) {
  EventReport report;
  ReadMember(json, "tick", report.tick);
  ReadMember(json, "event", report.event);
  ReadMember(json, "text", report.text);
  return report;
}

RunSummary ParseEnd(const Json& json) {
  RunSummary summary;
  ReadMember(json, "ticks", summary.ticks);
  ReadMember(json, "sim_seconds", summary.sim_seconds);
  ReadMember(json, "wall_seconds", summary.wall_seconds);
  ReadMember(json, "real_time_factor", summary.real_time_factor);
  ReadMember(json, "startup_seconds", summary.startup_seconds);
  ReadMember(json, "robots", summary.robots);
  ReadMember(json, "stalls", summary.stalls);
  ReadMember(json, "rejected", summary.rejected);
  ReadMember(json, "frames_repeated", summary.frames_repeated);
  ReadHash(json, "state_hash", summary.state_hash);
  for (const Json& entry : json.value("slowest", Json::array())) {
    SlowRobot slow;
    ReadMember(entry, "robot", slow.robot);
    ReadMember(entry, "times_last", slow.times_last);
    ReadMember(entry, "waited_seconds", slow.waited_seconds);
    summary.slowest.push_back(slow);
  }
  ReadMember(json, "lost", summary.lost);
  ReadMember(json, "interrupted", summary.interrupted);
  ReadMember(json, "record_waited_seconds", summary.record_waited_seconds);
  return summary;
}

std::optional<ServiceReport> Parse(const Json& json) {
  std::string type = json.value("type", "");
  if (type == "ready") return ParseReady(json);
  if (type == "robots") {
    NewRobotsReport report;
    ReadMember(json, "robots", report.robots);
    ReadMember(json, "edition", report.edition);
    return report;
  }
  if (type == "started") return StartedReport{};
  if (type == "status") {
    StatusMessage status;
    FieldsFromJson(json, status);
    return status;
  }
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
