#include "world-service/observers/status/reporter.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "common/base/json.h"
#include "common/base/json_reader.h"
#include "common/base/print.h"
#include "common/base/wake_event.h"
#include "transport/protocol/message_texts.h"
#include "world-service/service/requested_file.h"

namespace troupe {
namespace {

constexpr std::uint32_t kStatusesPerLine = 10;  // while no robot begins or ends to be late

class ConsoleReporter final : public Reporter {
 public:
  void Ready(const WorldDescription& world, const RunSettings&, const ServiceContact& contact) override {
    PrintPlain(stderr, "{}: {} robots; waiting for their agents", world.name, world.robots.size());
    if (!contact.participants.empty()) PrintPlain(stderr, " (port {})", contact.participants.front().port);
    PrintPlain(stderr, "\n");
  }
  void OnStarted(double startup_seconds) override {
    PrintPlain(stderr, "all robots have agents after {:.1f} s\n", startup_seconds);
  }
  void OnStatus(const StatusMessage& status) override {
    const bool news = status.waiting_for != waiting_for_;
    if (!news && ++statuses_ % kStatusesPerLine != 0) return;
    waiting_for_ = status.waiting_for;
    PrintPlain(stderr, "tick {}, {:.1f} s simulated, {:.2f} x real time{}{}\n", status.tick, status.sim_seconds,
               status.real_time_factor, status.waiting_for.empty() ? "" : "; waiting for ", WaitingText(status));
  }
  void OnEvent(const Event& event, const std::string& text) override {
    // Robots stall all the time, and doors open; the summary counts stalls.
    if (event.type == EventType::kStallBegan || event.type == EventType::kStallEnded) return;
    if (IsOfBuilding(event.type) || IsOfTraffic(event.type)) return;
    PrintPlain(stderr, "{}\n", text);
  }
  void OnNewRobots(const std::vector<std::string>& robots, Edition) override {
    for (const std::string& robot : robots) PrintPlain(stderr, "robot {} is new and needs an agent\n", robot);
  }
  void OnNotice(const std::string& text) override { PrintPlain(stderr, "{}\n", text); }
  void Ended(const RunSummary& summary) override {
    PrintPlain(stderr, "{} ticks, {:.1f} s simulated in {:.1f} s ({:.2f} x real time), {} stalls, state hash {:016x}\n",
               summary.ticks, summary.sim_seconds, summary.wall_seconds, summary.real_time_factor, summary.stalls,
               summary.state_hash);
    for (const SlowRobot& slow : summary.slowest) {
      PrintPlain(stderr, "  {}: last {} times, waited {:.2f} s\n", slow.robot, slow.times_last, slow.waited_seconds);
    }
    if (summary.record_waited_seconds > 0.0) {
      PrintPlain(stderr, "  ticks waited {:.2f} s for the recording to be written\n", summary.record_waited_seconds);
    }
    if (summary.frozen > 0) PrintPlain(stderr, "  {} robots had no agent in some ticks\n", summary.frozen);
    if (!summary.lost.empty()) PrintPlain(stderr, "  {} have no agent at the end\n", summary.lost.size());
  }
  void Failed(const Error& error) override { PrintPlain(stderr, "{}\n", error.ToString()); }

 private:
  std::uint32_t statuses_ = 0;
  std::vector<std::string> waiting_for_;  // as last printed
};

using Json = nlohmann::json;

// Reads lines from standard input on a thread of its own.
class NewsReader {
 public:
  explicit NewsReader(WorldControl& control) : thread_([this, &control] { Read(control); }) {}
  ~NewsReader() {
    ended_.Signal();
    thread_.join();
  }
  NewsReader(const NewsReader&) = delete;
  NewsReader& operator=(const NewsReader&) = delete;

 private:
  static constexpr std::size_t kPiece = 4096;  // bytes

  void Read(WorldControl& control) {
    std::string text;
    pollfd waited[] = {{STDIN_FILENO, POLLIN, 0}, {ended_.descriptor(), POLLIN, 0}};
    while (waited[1].revents == 0) {
      if (poll(waited, 2, -1) < 0 || waited[0].revents == 0) continue;
      char piece[kPiece];
      const ssize_t size = read(STDIN_FILENO, piece, sizeof piece);
      if (size == 0 || (size < 0 && errno != EINTR)) return;  // the launcher has died
      if (size > 0) text.append(piece, static_cast<std::size_t>(size));
      for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
        if (const std::optional<AgentNews> news = ParseAgentNews(text.substr(0, end))) control.OnAgentNews(*news);
      }
    }
  }

  WakeEvent ended_;
  std::thread thread_;
};

class LauncherReporter final : public Reporter {
 public:
  // A service that was killed may have left the start of a line on the descriptor: an empty line ends it.
  explicit LauncherReporter(int descriptor) : descriptor_(descriptor) { Write("\n"); }

  void Ready(const WorldDescription& world, const RunSettings& settings, const ServiceContact& contact) override {
    Json robots = Json::array();
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      if (RobotExists(world, RobotId(i))) robots.push_back(world.robots[i].name);
    }
    Json participants = Json::array();
    for (const ServiceParticipant& of_group : contact.participants) {
      participants.push_back({{"port", of_group.port}, {"participant", of_group.participant}});
    }
    Send({{"type", "ready"},
          {"robots", std::move(robots)},
          {"libraries", LibrariesOf(world)},
          {"robots_per_process", settings.robots_per_process},
          {"restart_agents", settings.restart_agents},
          {"aborts_on_loss", settings.on_agent_loss == OnAgentLoss::kAbort},
          {"rebuilds_on_loss", settings.on_agent_loss == OnAgentLoss::kRebuild},
          {"participants", std::move(participants)},
          {"ros", settings.ros},
          {"ros_infinite_ranges", settings.ros_infinite_ranges}});
  }
  Status OnBegin(const RunStart& start) override {
    news_.emplace(start.control);
    return {};
  }
  Status OnEnd() override {
    news_.reset();
    return {};
  }
  void OnStarted(double startup_seconds) override { Send({{"type", "started"}, {"startup_seconds", startup_seconds}}); }
  void OnNewRobots(const std::vector<std::string>& robots, Edition edition) override {
    Send({{"type", "robots"}, {"robots", robots}, {"edition", edition}});
  }
  void OnStatus(const StatusMessage& status) override {
    Json report = FieldsToJson<Json>(status);
    report["type"] = "status";
    Send(report);
  }
  void OnEvent(const Event& event, const std::string& text) override {
    Send({{"type", "event"}, {"tick", event.tick}, {"event", NameOf(event.type)}, {"text", text}});
  }
  void OnNotice(const std::string& text) override { Send({{"type", "notice"}, {"text", text}}); }
  void Ended(const RunSummary& summary) override {
    Json slowest = Json::array();
    for (const SlowRobot& slow : summary.slowest) {
      slowest.push_back(
          {{"robot", slow.robot}, {"times_last", slow.times_last}, {"waited_seconds", slow.waited_seconds}});
    }
    Json ros = Json::array();
    for (const SlowRobot& awaited : summary.ros) {
      ros.push_back(
          {{"name", awaited.robot}, {"times_last", awaited.times_last}, {"waited_seconds", awaited.waited_seconds}});
    }
    Json totals = Json::array();
    for (const RobotTotal& total : summary.totals) totals.push_back(FieldsToJson<Json>(total));
    Json flows = Json::array();
    for (const FlowTotal& flow : summary.flows) flows.push_back(FieldsToJson<Json>(flow));
    Json cleaning = Json::array();
    for (const CleaningTotal& zone : summary.cleaning) cleaning.push_back(FieldsToJson<Json>(zone));
    Json waits = Json::array();
    for (const PlaceWaits& place : summary.waits) waits.push_back(FieldsToJson<Json>(place));
    const Json trips = summary.trips ? FieldsToJson<Json>(*summary.trips) : Json();
    Send({{"type", "end"},
          {"ticks", summary.ticks},
          {"sim_seconds", summary.sim_seconds},
          {"wall_seconds", summary.wall_seconds},
          {"real_time_factor", summary.real_time_factor},
          {"startup_seconds", summary.startup_seconds},
          {"robots", summary.robots},
          {"stalls", summary.stalls},
          {"rejected", summary.rejected},
          {"frames_repeated", summary.frames_repeated},
          {"state_hash", fmt::format("{:016x}", summary.state_hash)},
          {"slowest", std::move(slowest)},
          {"ros_lockstep", std::move(ros)},
          {"lost", summary.lost},
          {"frozen", summary.frozen},
          {"interrupted", summary.interrupted},
          {"record_waited_seconds", summary.record_waited_seconds},
          {"totals", std::move(totals)},
          {"totals_since", summary.totals_since},
          {"traffic", FieldsToJson<Json>(summary.traffic)},
          {"waits", std::move(waits)},
          {"flows", std::move(flows)},
          {"cleaning", std::move(cleaning)},
          {"trips", trips}});
  }
  void Failed(const Error& error) override {
    Send({{"type", "error"}, {"message", error.ToString()}});
    fmt::print(stderr, "{}\n", error.ToString());
  }

 private:
  // Reports are dropped once the launcher has died: the run continues until it is stopped.
  void Send(const Json& report) { Write(JsonText(report) + "\n"); }
  void Write(const std::string& line) {
    for (std::size_t sent = 0; sent < line.size();) {
      const ssize_t written = write(descriptor_, line.data() + sent, line.size() - sent);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return;
      sent += static_cast<std::size_t>(written);
    }
  }

  const int descriptor_;
  std::optional<NewsReader> news_;  // while the run lasts
};

}  // namespace

std::optional<AgentNews> ParseAgentNews(const std::string& line) {
  const JsonReader json = JsonReader::OfText(line, "", JsonLimits::OfProcesses());
  AgentNews news;
  json.ReadHash("agent", news.agent);
  json.Read("end", news.end);
  return json.ok() && news.agent != 0 ? std::optional(news) : std::nullopt;
}

std::unique_ptr<Reporter> MakeConsoleReporter() {
  return std::make_unique<ConsoleReporter>();
}

std::unique_ptr<Reporter> MakeLauncherReporter(int descriptor) {
  return std::make_unique<LauncherReporter>(descriptor);
}

}  // namespace troupe
