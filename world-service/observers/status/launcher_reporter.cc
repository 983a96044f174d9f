#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/base/json_fields.h"
#include "common/base/json_text.h"
#include "world-service/observers/status/reporter.h"
#include "world-service/service/owner_permissions.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

class LauncherReporter final : public Reporter {
 public:
  // A service that was killed may have left the start of a line on the descriptor: an empty line ends it.
  explicit LauncherReporter(int descriptor) : descriptor_(descriptor) { Write("\n"); }

  void Ready(const WorldDescription& world, const RunSettings& settings, const ServiceContact& contact) override {
    Json robots = Json::array();
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      if (IsThere(world, RobotId(i))) robots.push_back(world.robots[i].name);
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
    Send({{"type", "event"}, {"tick", event.tick}, {"event", ToString(event.type)}, {"text", text}});
  }
  void OnNotice(const std::string& text) override { Send({{"type", "notice"}, {"text", text}}); }
  void Ended(const RunSummary& summary) override {
    Json slowest = Json::array();
    for (const SlowRobot& slow : summary.slowest) {
      slowest.push_back(
          {{"robot", slow.robot}, {"times_last", slow.times_last}, {"waited_seconds", slow.waited_seconds}});
    }
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
          {"lost", summary.lost},
          {"interrupted", summary.interrupted},
          {"record_waited_seconds", summary.record_waited_seconds}});
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
};

}  // namespace

std::unique_ptr<Reporter> MakeLauncherReporter(int descriptor) {
  return std::make_unique<LauncherReporter>(descriptor);
}

}  // namespace troupe
