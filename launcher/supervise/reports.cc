#include "launcher/supervise/reports.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "command_line/terminal.h"
#include "common/base/json.h"
#include "common/base/json_reader.h"
#include "common/base/source_text.h"
#include "common/base/text.h"
#include "transport/protocol/message_texts.h"
#include "troupe/event.h"

namespace troupe {
namespace {

// `name`: the member with the name of each.
// The report and the summary file have the same members under two names.
std::vector<SlowRobot> ReadSlow(const JsonReader& object, const char* list, const char* name) {
  std::vector<SlowRobot> read;
  for (const JsonReader& entry : object.ItemsOf(list)) {
    SlowRobot& slow = read.emplace_back();
    entry.Read(name, slow.robot);
    entry.Read("times_last", slow.times_last);
    entry.Read("waited_seconds", slow.waited_seconds);
  }
  return read;
}

nlohmann::ordered_json ToJson(const SlowRobot& slow, const char* name) {
  return {{name, slow.robot}, {"times_last", slow.times_last}, {"waited_seconds", slow.waited_seconds}};
}

ReadyReport ReadReady(const JsonReader& json) {
  ReadyReport report;
  json.Read("robots", report.robots);
  json.Read("libraries", report.libraries);
  json.Read("robots_per_process", report.robots_per_process);
  json.Read("restart_agents", report.restart_agents);
  json.Read("aborts_on_loss", report.aborts_on_loss);
  json.Read("rebuilds_on_loss", report.rebuilds_on_loss);
  for (const JsonReader& entry : json.ItemsOf("participants")) {
    ServiceParticipant& of_group = report.participants.emplace_back();
    entry.Read("port", of_group.port);
    entry.Read("participant", of_group.participant);
  }
  if (report.participants.empty()) report.participants.emplace_back();
  json.Read("ros", report.ros);
  json.Read("ros_infinite_ranges", report.ros_infinite_ranges);
  return report;
}

EventReport ReadEvent(const JsonReader& json) {
  EventReport report;
  json.Read("tick", report.tick);
  json.Read("event", report.event);
  json.Read("text", report.text);
  return report;
}

RunSummary ReadEnd(const JsonReader& json) {
  RunSummary summary;
  json.Read("ticks", summary.ticks);
  json.Read("sim_seconds", summary.sim_seconds);
  json.Read("wall_seconds", summary.wall_seconds);
  json.Read("real_time_factor", summary.real_time_factor);
  json.Read("startup_seconds", summary.startup_seconds);
  json.Read("robots", summary.robots);
  json.Read("stalls", summary.stalls);
  json.Read("rejected", summary.rejected);
  json.Read("frames_repeated", summary.frames_repeated);
  json.ReadHash("state_hash", summary.state_hash);
  summary.slowest = ReadSlow(json, "slowest", "robot");
  summary.ros = ReadSlow(json, "ros_lockstep", "name");
  json.Read("lost", summary.lost);
  json.Read("frozen", summary.frozen);
  json.Read("interrupted", summary.interrupted);
  json.Read("record_waited_seconds", summary.record_waited_seconds);
  json.Read("totals", summary.totals);
  json.Read("traffic", summary.traffic);
  json.Read("waits", summary.waits);
  json.Read("totals_since", summary.totals_since);
  json.Read("flows", summary.flows);
  json.Read("cleaning", summary.cleaning);
  const std::optional<JsonReader> trips = json.Find("trips");
  if (trips && trips->node().is_object()) trips->To(summary.trips.emplace());
  return summary;
}

// Members that are missing keep their defaults; a member of a wrong type makes the line no report (JsonReader::ok).
std::optional<ServiceReport> ReadReport(const JsonReader& json) {
  const auto type = json.Get<std::string>("type");
  if (type == "ready") return ReadReady(json);
  if (type == "robots") {
    NewRobotsReport report;
    json.Read("robots", report.robots);
    json.Read("edition", report.edition);
    return report;
  }
  if (type == "started") return StartedReport{};
  if (type == "status") {
    StatusMessage status;
    json.To(status);
    return status;
  }
  if (type == "event" || type == "notice") return ReadEvent(json);
  if (type == "end") return ReadEnd(json);
  return std::nullopt;
}

constexpr auto kTimeBetweenLines = std::chrono::seconds(5);

// A longer line would wrap, and the next one would not cover it.
std::size_t TerminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

// As people say it: "7 s", "4 min", "3 h". Empty: not known.
// By the speed of the run so far. Whole units and rounded up: a precise figure would change in each line.
std::string TimeLeft(const StatusMessage& status) {
  if (status.target_ticks <= status.tick || status.tick == 0 || !(status.real_time_factor > 0.0)) return "";
  const double seconds_per_tick = status.sim_seconds / static_cast<double>(status.tick) / status.real_time_factor;
  const double seconds = static_cast<double>(status.target_ticks - status.tick) * seconds_per_tick;
  if (seconds < 100.0) return fmt::format("{:.0f} s", std::ceil(seconds));
  if (seconds < 6000.0) return fmt::format("{:.0f} min", std::ceil(seconds / 60.0));
  return fmt::format("{:.0f} h", std::ceil(seconds / 3600.0));
}

std::string HashText(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

// A run of a thousand robots must not print a thousand names in one line.
constexpr std::size_t kNamesListed = 10;
constexpr std::size_t kLinesOfMany = 10;  // in a second

}  // namespace

std::string ListText(const std::vector<std::string>& names) {
  const std::size_t listed = std::min(names.size(), kNamesListed);
  const std::vector<std::string> first(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(listed));
  const std::string more = names.size() > listed ? fmt::format(" and {} more", names.size() - listed) : "";
  return PlainLine(fmt::format("{}", fmt::join(first, ", "))) + more;
}

std::optional<ServiceReport> ParseServiceReport(const std::string& line) {
  const JsonReader json = JsonReader::OfText(line, "", JsonLimits::OfProcesses());
  std::optional<ServiceReport> report = ReadReport(json);
  return json.ok() ? std::move(report) : std::nullopt;
}

// The first part is the newest tick, which a terminal that is too narrow keeps.
std::string StatusText(const StatusMessage& status) {
  std::string text = fmt::format("tick {}", status.tick);
  if (status.target_ticks > 0) text += fmt::format("/{}", status.target_ticks);
  text += fmt::format(", {:.1f} s, {:.1f} x real time", status.sim_seconds, status.real_time_factor);
  if (const std::string left = TimeLeft(status); !left.empty()) text += ", " + left + " left";
  text += ", " + CountText(status.robots, "robot");
  if (!status.waiting_for.empty()) text += ", waiting for " + WaitingText(status);
  return text;
}

Progress::Progress()
    : terminal_(isatty(STDERR_FILENO) == 1),
      has_styles_(HasStyles(stderr)),
      next_line_(std::chrono::steady_clock::now() + kTimeBetweenLines) {}

bool Progress::IsInteractive() {
  return isatty(STDERR_FILENO) == 1 && isatty(STDIN_FILENO) == 1;
}

void Progress::OnStopRequest() {
  ClearStatusLine();
  ClearLine();
}

Progress::~Progress() {
  ClearStatusLine();
}

// In a log (no terminal) a line replaces none, so that there are few.
void Progress::Update(const StatusMessage& status) {
  TellNumberOfOthers(false);
  if (terminal_) {
    ClearStatusLine();
    status_line_ = PlainLine(StatusText(status), TerminalWidth() - 1);
    fmt::print(stderr, "{}", Styled(TerminalStyle::kDim, status_line_, has_styles_));
    std::fflush(stderr);
  } else if (std::chrono::steady_clock::now() >= next_line_) {
    Tell(StatusText(status));
    next_line_ = std::chrono::steady_clock::now() + kTimeBetweenLines;
  }
}

// Frequent events are in recordings and event topics, for users who need each.
void Progress::TellEvent(Tick tick, const std::string& event, const std::string& text) {
  const std::optional<EventType> type = FindByName<EventType>(event);
  const bool is_frequent = type && (type == EventType::kStallBegan || type == EventType::kStallEnded ||
                                    IsOfBuilding(*type) || IsOfTraffic(*type));
  // Agents that join at tick 0 begin the run, unless one has been lost since.
  const bool start = tick == 0 && type == EventType::kJoined && !has_lost_agent_;
  has_lost_agent_ = has_lost_agent_ || type == EventType::kLeft;
  if (!is_frequent && !start) Tell(text);
}

// The status line is removed and printed again below the new line. Names of users are printed as plain text: no escape
// sequence of a world reaches the terminal.
void Progress::Tell(const std::string& line, const std::string& command) {
  std::string kept = status_line_;
  ClearStatusLine();
  const std::string below = command.empty() ? "" : "  " + PlainLine(command) + "\n";
  fmt::print(stderr, "{}\n{}{}", StyledLine(PlainLine(line), has_styles_), below,
             Styled(TerminalStyle::kDim, kept, has_styles_ && !kept.empty()));
  std::fflush(stderr);
  status_line_ = kept;
}

void Progress::TellOneOfMany(const std::string& line, const std::string& command) {
  TellNumberOfOthers(false);
  if (of_many_ == 0) second_began_ = std::chrono::steady_clock::now();
  if (++of_many_ <= kLinesOfMany) Tell(line, command);
}

void Progress::TellNumberOfOthers(bool ends) {
  if (!ends && std::chrono::steady_clock::now() < second_began_ + std::chrono::seconds(1)) return;
  const std::size_t lines = std::exchange(of_many_, 0);
  if (lines > kLinesOfMany) Tell(fmt::format("and {} more lines of this kind", lines - kLinesOfMany));
}

void Progress::End() {
  TellNumberOfOthers(true);
  ClearStatusLine();
}

void Progress::ClearStatusLine() {
  if (status_line_.empty()) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  status_line_.clear();
}

namespace {

constexpr std::size_t kRobotsShown = 12;

// A column without use in any robot (no goals, no battery) is left out.
struct Column {
  std::string heading;
  std::string (*text)(const RobotTotal& total);
  bool (*is_used)(const RobotTotal& total);
  bool to_the_right = true;
};

// Stalls, and the names of the things that were touched.
std::string ContactsText(const RobotTotal& total) {
  if (total.stalls == 0) return "none";
  std::string text = std::to_string(total.stalls);
  if (!total.contacts.empty()) text += ": " + ListText(total.contacts);
  return text;
}

constexpr auto kAlways = [](const RobotTotal&) { return true; };

const std::array<Column, 6>& Columns() {
  static const std::array<Column, 6> columns = {{
      {"robot", [](const RobotTotal& t) { return PlainLine(t.robot, 30); }, kAlways, false},
      {"distance", [](const RobotTotal& t) { return fmt::format("{:.1f} m", t.distance); }, kAlways},
      {"goals", [](const RobotTotal& t) { return fmt::format("{} of {}", t.goals_reached, t.goals); },
       [](const RobotTotal& t) { return t.goals > 0; }},
      {"gripped", [](const RobotTotal& t) { return std::to_string(t.grips); },
       [](const RobotTotal& t) { return t.grips > 0; }},
      {"energy",
       [](const RobotTotal& t) {
         if (!t.joules || !(t.capacity.value_or(0.0) > 0.0)) return std::string("-");
         return fmt::format("{:.0f} %", 100.0 * *t.joules / *t.capacity);
       },
       [](const RobotTotal& t) { return t.joules.has_value(); }},
      {"contacts", ContactsText, kAlways, false},
  }};
  return columns;
}

// A table of the first robots; empty without any.
std::string RobotsText(const RunSummary& run, bool has_styles) {
  if (run.totals.empty()) return "";
  const std::size_t shown = std::min(run.totals.size(), kRobotsShown);
  std::vector<std::string> lines(shown + 1);
  for (const Column& column : Columns()) {
    if (std::none_of(run.totals.begin(), run.totals.end(), column.is_used)) continue;
    std::vector<std::string> cells = {column.heading};
    for (std::size_t i = 0; i < shown; ++i) cells.push_back(column.text(run.totals[i]));
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    const bool is_last = &column == &Columns().back();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!lines[i].empty()) lines[i] += "  ";
      const std::string space(width - cells[i].size(), ' ');
      lines[i] += column.to_the_right ? space + cells[i] : cells[i] + (is_last ? "" : space);
    }
  }
  std::string text = Styled(TerminalStyle::kBold, lines[0], has_styles) + "\n";
  for (std::size_t i = 1; i < lines.size(); ++i) text += lines[i] + "\n";
  if (run.robots > shown) text += fmt::format("and {} more robots (--summary FILE has them)\n", run.robots - shown);
  if (run.totals_since > 0) text += fmt::format("of the ticks since {}, at which it was restarted\n", run.totals_since);
  return text;
}

// A line for each flow of goods and each cleaning zone.
std::string SiteText(const RunSummary& run) {
  std::string text;
  for (const FlowTotal& flow : run.flows) {
    text += fmt::format("{}: {} of {} goods delivered, {:.1f} in an hour, {} late", PlainLine(flow.flow, 60),
                        flow.delivered, flow.arrived, flow.per_hour, flow.late);
    if (flow.late > 0) text += fmt::format(" by {:.0f} s", flow.lateness);
    text += fmt::format(", {} waiting", flow.waiting);
    if (flow.refused > 0) text += fmt::format(", {} refused", flow.refused);
    text += "\n";
  }
  for (const CleaningTotal& zone : run.cleaning) {
    text += fmt::format("{}: {:.0f} % cleaned\n", PlainLine(zone.zone, 60), 100.0 * zone.share);
  }
  return text;
}

constexpr std::size_t kPlacesShown = 3;  // of a kind

// Of robots on lanes: how they flow, and where they wait most. Empty without any.
std::string TrafficText(const RunSummary& run) {
  std::string text;
  const TrafficTotal& traffic = run.traffic;
  if (traffic.robots > 0) {
    text += fmt::format("{} on lanes: {} ({:.0f} an hour), {:.0f} % of their time moving to goals, {:.0f} % waiting\n",
                        CountText(traffic.robots, "robot"), CountText(traffic.arrivals, "arrival"),
                        traffic.arrivals_per_hour, 100.0 * traffic.utilisation, 100.0 * traffic.waiting);
  }
  std::map<std::string, std::size_t> shown;  // by kind
  for (const PlaceWaits& place : run.waits) {
    if (++shown[place.kind] > kPlacesShown) continue;
    text += fmt::format("waits at {} {}: {:.1f} s in {}, the longest {:.1f} s\n", place.kind,
                        PlainLine(place.place, 60), place.seconds, CountText(place.waits, "wait"), place.longest);
  }
  return text;
}

// The outcome of a problem of paths.
std::string TripsText(const TripSummary& trips) {
  const std::string arrived = trips.arrived == trips.robots
                                  ? CountText(trips.robots, "robot") + " arrived"
                                  : fmt::format("{} of {} arrived", trips.arrived, CountText(trips.robots, "robot"));
  return fmt::format("{}, {} visited, makespan {:.1f} s, flow time {:.1f} s, {:.2f} goals a second\n", arrived,
                     CountText(trips.goals, "goal"), trips.makespan, trips.flow_time, trips.throughput);
}

// What only those want to know who look after the processes.
std::string ProcessesText(const RunOutcome& outcome) {
  const RunSummary& run = outcome.run;
  std::string text = fmt::format("{} {}, first tick after {:.2f} s\n", outcome.processes,
                                 outcome.processes == 1 ? "process" : "processes", run.startup_seconds);
  // One process has no network, and its robots take turns: nothing is late.
  const bool distributed = outcome.processes > 1;
  if (distributed && run.frames_repeated > 0) text += fmt::format("{} frames resent\n", run.frames_repeated);
  text += fmt::format("peak memory: {:.1f} MiB", outcome.service_peak_memory_mib);
  if (distributed) {
    text += fmt::format(" the world service, {:.1f} MiB the largest agent", outcome.agent_peak_memory_mib);
  }
  text += "\n";
  if (distributed && !run.slowest.empty()) {
    std::vector<std::string> slowest;
    for (const SlowRobot& slow : run.slowest) {
      auto host = outcome.hosts.find(slow.robot);
      std::string name = slow.robot + (host == outcome.hosts.end() ? "" : " on " + host->second);
      slowest.push_back(fmt::format("{} (last {} times, {:.3f} s)", name, slow.times_last, slow.waited_seconds));
    }
    text += "slowest robots: " + ListText(slowest) + "\n";
  }
  if (!run.ros.empty()) {
    std::vector<std::string> awaited;
    for (std::size_t i = 0; i < std::min<std::size_t>(run.ros.size(), 5); ++i) {
      const SlowRobot& of_ros = run.ros[i];
      awaited.push_back(
          fmt::format("{} (last {} times, {:.3f} s)", of_ros.robot, of_ros.times_last, of_ros.waited_seconds));
    }
    text += "ticks waited for ROS: " + ListText(awaited) + "\n";
  }
  if (run.record_waited_seconds > 0.0) {
    text += fmt::format("ticks waited {:.2f} s for the recording to be written\n", run.record_waited_seconds);
  }
  return text;
}

}  // namespace

// Figures of the simulation come first; faults of processes only where there were any.
std::string SummaryText(const RunOutcome& outcome, const SummaryTextOptions& options) {
  const RunSummary& run = outcome.run;
  std::string text;
  if (run.interrupted) text += "stopped before its end\n";
  text += fmt::format("{}, {:.1f} s simulated in {:.2f} s: {:.1f} x real time\n", CountText(run.ticks, "tick"),
                      run.sim_seconds, run.wall_seconds, run.real_time_factor);
  text += fmt::format("{}, {}, state hash {}\n", CountText(run.robots, "robot"), CountText(run.stalls, "stall"),
                      HashText(run.state_hash));
  if (run.trips) text += TripsText(*run.trips);
  text += RobotsText(run, options.has_styles);
  text += SiteText(run);
  text += TrafficText(run);
  if (run.rejected > 0) text += CountText(run.rejected, "proposal") + " rejected\n";
  if (options.with_stats) text += ProcessesText(outcome);
  if (outcome.service_restarted > 0) {
    text += CountText(outcome.service_restarted, "restart") + " of the world service, which died\n";
  }
  if (outcome.agents_restarted > 0) text += CountText(outcome.agents_restarted, "restart") + " of agents that died\n";
  for (const std::string& missing : outcome.missing_files) text += "missing: " + missing + "\n";
  if (run.frozen > 0) {
    text += CountText(run.frozen, "robot") +
            " stood still in some ticks, without an agent: the result depends on the time "
            "of the loss\n";
  }
  if (!run.lost.empty()) text += "without an agent at the end: " + ListText(run.lost) + "\n";
  return text;
}

// All members of the object are always there, with zeros and empty lists, so that scripts need no case for an absent
// one.
std::string SummaryJson(const RunOutcome& outcome) {
  const RunSummary& run = outcome.run;
  nlohmann::ordered_json slowest = nlohmann::ordered_json::array();
  for (const SlowRobot& slow : run.slowest) {
    slowest.push_back(ToJson(slow, "robot"));
    if (auto host = outcome.hosts.find(slow.robot); host != outcome.hosts.end()) slowest.back()["host"] = host->second;
  }
  nlohmann::ordered_json ros = nlohmann::ordered_json::array();
  for (const SlowRobot& awaited : run.ros) ros.push_back(ToJson(awaited, "name"));
  nlohmann::ordered_json totals = nlohmann::ordered_json::array();
  for (const RobotTotal& total : run.totals) totals.push_back(FieldsToJson<nlohmann::ordered_json>(total));
  nlohmann::ordered_json flows = nlohmann::ordered_json::array();
  for (const FlowTotal& flow : run.flows) flows.push_back(FieldsToJson<nlohmann::ordered_json>(flow));
  nlohmann::ordered_json cleaning = nlohmann::ordered_json::array();
  for (const CleaningTotal& zone : run.cleaning) cleaning.push_back(FieldsToJson<nlohmann::ordered_json>(zone));
  nlohmann::ordered_json waits = nlohmann::ordered_json::array();
  for (const PlaceWaits& place : run.waits) waits.push_back(FieldsToJson<nlohmann::ordered_json>(place));
  const nlohmann::ordered_json trips = run.trips ? FieldsToJson<nlohmann::ordered_json>(*run.trips) : nullptr;
  nlohmann::ordered_json json = {
      {"ticks", run.ticks},
      {"sim_seconds", run.sim_seconds},
      {"wall_seconds", run.wall_seconds},
      {"real_time_factor", run.real_time_factor},
      {"robots", run.robots},
      {"processes", outcome.processes},
      {"agents_restarted", outcome.agents_restarted},
      {"service_restarted", outcome.service_restarted},
      {"startup_seconds", run.startup_seconds},
      {"stalls", run.stalls},
      {"rejected", run.rejected},
      {"frames_repeated", run.frames_repeated},
      {"state_hash", HashText(run.state_hash)},
      {"service_peak_memory_mib", outcome.service_peak_memory_mib},
      {"agent_peak_memory_mib", outcome.agent_peak_memory_mib},
      {"slowest_robots", slowest},
      {"ros_lockstep", ros},
      {"robot_totals", std::move(totals)},
      {"flows", std::move(flows)},
      {"cleaning", std::move(cleaning)},
      {"traffic", FieldsToJson<nlohmann::ordered_json>(run.traffic)},
      {"waits", std::move(waits)},
      {"trips", trips},
      {"lost", run.lost},
      {"frozen", run.frozen},
      {"missing_files", outcome.missing_files},
      {"interrupted", run.interrupted},
      {"record_waited_seconds", run.record_waited_seconds},
  };
  return JsonText(json, {.indent = 2});
}

}  // namespace troupe
