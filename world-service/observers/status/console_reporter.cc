#include <fmt/format.h>

#include <cstdio>

#include "common/base/print.h"
#include "transport/protocol/waiting_text.h"
#include "world-service/observers/status/reporter.h"

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
    // Robots stall all the time; the summary counts them.
    if (event.type == EventType::kStallBegan || event.type == EventType::kStallEnded) return;
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
    for (const std::string& robot : summary.lost) PrintPlain(stderr, "  {}: no agent at the end\n", robot);
  }
  void Failed(const Error& error) override { PrintPlain(stderr, "{}\n", error.ToString()); }

 private:
  std::uint32_t statuses_ = 0;
  std::vector<std::string> waiting_for_;  // as last printed
};

}  // namespace

std::unique_ptr<Reporter> MakeConsoleReporter() {
  return std::make_unique<ConsoleReporter>();
}

}  // namespace troupe
