#include "world-service/service/run_statistics.h"

#include <algorithm>

namespace troupe {
namespace {

constexpr double kUsualDelay = 0.2;  // s of wall time for which a missing proposal is not reported
constexpr std::size_t kSlowestListed = 5;

}  // namespace

std::vector<std::string> RunStatistics::MissingRobots(double now) const {
  const bool running = run_.phase == RunPhase::kRunning;
  const bool all_absent = run_.phase == RunPhase::kGathering || (running && engine_.halted());
  std::vector<RobotId> robots = all_absent ? run_.members.AbsentRobots() : editor_.robots_without_agent();
  if (running && now - engine_.committed_at() > kUsualDelay) {
    for (AgentId agent : engine_.MissingMembers()) {
      const std::vector<RobotId>& of_agent = run_.members.member(agent).robots;
      robots.insert(robots.end(), of_agent.begin(), of_agent.end());
    }
  }
  std::sort(robots.begin(), robots.end());
  std::vector<std::string> names;
  for (RobotId robot : robots) names.push_back(run_.world().robot(robot).name);
  return names;
}

StatusMessage RunStatistics::MakeStatus(double now) {
  const double interval = run_.world().interval_seconds();
  StatusMessage status;
  status.run = run_.options.run;
  status.tick = run_.frame.state.tick;
  status.target_ticks = run_.options.settings.ticks.value_or(0);
  status.sim_seconds = static_cast<double>(status.tick) * interval;
  status.robots = static_cast<std::uint32_t>(run_.members.robots());
  status.agents = static_cast<std::uint32_t>(run_.members.present_members());
  status.edition = run_.frame.edition;
  status.incarnation = run_.options.incarnation;
  status.speed = engine_.speed();
  if (const PhaseTimes* const times = run_.options.phase_times; times != nullptr) {
    status.phases = {times->Mean(TickPhase::kWait), times->Mean(TickPhase::kStep), times->Mean(TickPhase::kRecord),
                     times->Mean(TickPhase::kPublish)};
  }
  status.waiting_for = MissingRobots(now);
  if (!status.waiting_for.empty()) {
    status.waiting_seconds = now - (run_.phase == RunPhase::kGathering ? run_.created_at : engine_.committed_at());
  }
  if (run_.started_at) status.wall_seconds = now - *run_.started_at;
  if (now > status_at_) {
    status.real_time_factor = static_cast<double>(engine_.steps() - status_steps_) * interval / (now - status_at_);
  }
  status_at_ = now;
  status_steps_ = engine_.steps();
  return status;
}

RunSummary RunStatistics::MakeSummary() const {
  const double interval = run_.world().interval_seconds();
  RunSummary summary;
  summary.ticks = run_.frame.state.tick;
  summary.sim_seconds = static_cast<double>(summary.ticks) * interval;
  if (run_.started_at) {
    summary.startup_seconds = *run_.started_at - run_.created_at;
    summary.wall_seconds = engine_.committed_at() - *run_.started_at;
  }
  if (summary.wall_seconds > 0.0) {
    summary.real_time_factor = static_cast<double>(engine_.steps()) * interval / summary.wall_seconds;
  }
  summary.robots = static_cast<std::uint32_t>(run_.members.robots());
  summary.stalls = run_.events.stalls();
  summary.rejected = run_.events.rejected();
  summary.frames_repeated = engine_.frames_resent();
  summary.state_hash = run_.frame.state_hash;
  summary.slowest = SlowestRobots();
  summary.lost = run_.lost_robots;
  summary.interrupted = run_.interrupted;
  summary.record_waited_seconds = engine_.observers_waited_seconds();
  return summary;
}

std::vector<SlowRobot> RunStatistics::SlowestRobots() const {
  std::vector<SlowRobot> slowest;
  const std::vector<Membership::Waits> waits = run_.members.WaitsOfRobots();
  for (std::size_t i = 0; i < waits.size(); ++i) {
    if (waits[i].times_last == 0) continue;
    slowest.push_back({run_.world().robots[i].name, waits[i].times_last, waits[i].waited_seconds});
  }
  std::stable_sort(slowest.begin(), slowest.end(),
                   [](const SlowRobot& a, const SlowRobot& b) { return a.waited_seconds > b.waited_seconds; });
  if (slowest.size() > kSlowestListed) slowest.resize(kSlowestListed);
  return slowest;
}

}  // namespace troupe
