#include "viewer/gateway/metrics.h"

#include <fmt/format.h>

#include <utility>

#include "common/base/text.h"

namespace troupe {
namespace {

// The value of a label: names of users may have any characters.
std::string Quoted(const std::string& value) {
  std::string text = "\"";
  for (const char c : PlainLine(value)) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

// The format wants HELP and TYPE once before the lines of a figure.
class Writer {
 public:
  explicit Writer(const std::string& session) : labels_("session=" + Quoted(session)) {}

  template <typename Value>
  void Gauge(const char* name, const char* meaning, Value value, const std::string& labels = "") {
    Describe(name, meaning, "gauge");
    Add(name, value, labels);
  }
  template <typename Value>
  void Counter(const char* name, const char* meaning, Value value) {
    Describe(name, meaning, "counter");
    Add(name, value);
  }
  void Describe(const char* name, const char* meaning, const char* type) {
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, meaning, name, type);
  }
  // A further line of the figure described last. `labels`: beside the session's.
  template <typename Value>
  void Add(const char* name, Value value, const std::string& labels = "") {
    text_ += fmt::format("{}{{{}{}{}}} {}\n", name, labels_, labels.empty() ? "" : ",", labels, value);
  }
  std::string Release() { return std::move(text_); }

 private:
  const std::string labels_;
  std::string text_;
};

}  // namespace

// The first of several with the same time, in the order of the list.
std::optional<SlowestRobot> SlowestOf(const std::vector<EntityReport>& entities) {
  const EntityReport* slowest = nullptr;
  for (const EntityReport& entity : entities) {
    if (!entity.agent || !entity.agent->present || entity.agent->answer_seconds <= 0.0) continue;
    if (slowest == nullptr || entity.agent->answer_seconds > slowest->agent->answer_seconds) slowest = &entity;
  }
  if (slowest == nullptr) return std::nullopt;
  return SlowestRobot{slowest->name, slowest->agent->host, slowest->agent->answer_seconds};
}

std::string MetricsText(const std::string& session, const FeedHead& head, const AgentLosses& losses,
                        const std::optional<SlowestRobot>& slowest) {
  Writer writer(session);
  const bool is_known = head.state != nullptr && head.status.has_value();
  writer.Gauge("troupe_up", "1: the run is followed, 0: it was not found yet, or its service is gone",
               is_known ? 1 : 0);
  if (!is_known) return writer.Release();

  const StatusMessage& status = *head.status;
  const double tick_seconds = head.state->world->description().interval_seconds();
  writer.Gauge("troupe_tick", "Newest tick; an edit can set it back", head.state->state->tick);
  writer.Gauge("troupe_ticks_per_second", "Ticks in a second of wall time, over the last period of the status",
               status.real_time_factor / tick_seconds);
  writer.Gauge("troupe_real_time_factor", "Simulated time by wall time, over the same period", status.real_time_factor);
  writer.Gauge("troupe_paused", "1: the run is paused", head.paused ? 1 : 0);
  writer.Gauge("troupe_over", "1: the run has ended in order", head.last ? 1 : 0);
  writer.Gauge("troupe_robots", "Robots of the world", status.robots);
  writer.Gauge("troupe_agents", "Agents in the run, each of one or more robots", status.agents);
  writer.Gauge("troupe_awaited_robots", "Robots whose answers the tick has waited for, for a while",
               status.waiting_for.size());
  writer.Gauge("troupe_waiting_seconds", "Wall time for which the tick has waited", status.waiting_seconds);
  const char* const phases = "troupe_phase_seconds";
  writer.Describe(phases, "Mean wall time of the phases of a tick in the world service", "gauge");
  for (const auto& [phase, seconds] :
       {std::pair("wait", status.phases.wait), std::pair("step", status.phases.step),
        std::pair("record", status.phases.record), std::pair("publish", status.phases.publish)}) {
    writer.Add(phases, seconds, fmt::format("phase=\"{}\"", phase));
  }
  if (slowest) {
    writer.Gauge("troupe_slowest_answer_seconds",
                 "Smoothed wall time from a frame to its answer, of the slowest robot at the request before",
                 slowest->answer_seconds,
                 fmt::format("robot={},host={}", Quoted(slowest->robot), Quoted(slowest->host)));
  }
  writer.Counter("troupe_service_restarts_total", "World services that have continued the run of another one",
                 status.incarnation);
  writer.Counter("troupe_agents_lost_total", "Robots that have lost their agents since the run is followed",
                 losses.lost);
  writer.Counter("troupe_agents_rejoined_total", "Of those, robots that have an agent again", losses.rejoined);
  return writer.Release();
}

}  // namespace troupe
