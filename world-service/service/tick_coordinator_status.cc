// What a TickCoordinator tells about its run.
#include <algorithm>

#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

constexpr double kMoment = 0.2;  // s of wall time that a proposal may be missing without being named
constexpr std::size_t kSlowestListed = 5;

}  // namespace

std::vector<std::string> TickCoordinator::MissingRobots(double now) const {
  std::vector<RobotId> robots;
  const bool all_absent = phase_ == Phase::kGathering || (phase_ == Phase::kRunning && halted());
  robots = all_absent ? members_.AbsentRobots() : newcomers_;
  if (phase_ == Phase::kRunning && now - committed_at_ > kMoment) {
    for (AgentId agent : barrier_.Missing()) {
      const std::vector<RobotId>& of_agent = members_.Get(agent).robots;
      robots.insert(robots.end(), of_agent.begin(), of_agent.end());
    }
  }
  std::sort(robots.begin(), robots.end());
  std::vector<std::string> names;
  for (RobotId robot : robots) names.push_back(scene_->world().robot(robot).name);
  return names;
}

StatusMessage TickCoordinator::MakeStatus(double now) {
  const double interval = scene_->world().interval_seconds();
  StatusMessage status;
  status.run = options_.run;
  status.tick = frame_.state.tick;
  status.target_ticks = options_.settings.ticks.value_or(0);
  status.sim_seconds = static_cast<double>(status.tick) * interval;
  status.robots = static_cast<std::uint32_t>(members_.robots());
  status.agents = static_cast<std::uint32_t>(members_.present_members());
  status.edition = frame_.edition;
  status.waiting_for = MissingRobots(now);
  if (!status.waiting_for.empty()) {
    status.waiting_seconds = now - (phase_ == Phase::kGathering ? created_at_ : committed_at_);
  }
  if (started_at_) status.wall_seconds = now - *started_at_;
  if (now > status_at_) {
    status.real_time_factor = static_cast<double>(steps_made_ - status_steps_) * interval / (now - status_at_);
  }
  status_at_ = now;
  status_steps_ = steps_made_;
  return status;
}

RunSummary TickCoordinator::MakeSummary() const {
  RunSummary summary;
  summary.ticks = frame_.state.tick;
  summary.sim_seconds = static_cast<double>(summary.ticks) * scene_->world().interval_seconds();
  if (started_at_) {
    summary.startup_seconds = *startup_seconds();
    summary.wall_seconds = committed_at_ - *started_at_;
  }
  if (summary.wall_seconds > 0.0) {
    summary.real_time_factor =
        static_cast<double>(steps_made_) * scene_->world().interval_seconds() / summary.wall_seconds;
  }
  summary.robots = static_cast<std::uint32_t>(members_.robots());
  summary.stalls = events_.stalls();
  summary.rejected = events_.rejected();
  summary.frames_repeated = frames_repeated_;
  summary.state_hash = frame_.state_hash;
  summary.lost = lost_at_end_;
  summary.interrupted = interrupted_;

  const std::vector<Membership::Waits> waits = members_.WaitsOfRobots();
  for (std::size_t i = 0; i < waits.size(); ++i) {
    if (waits[i].times_last == 0) continue;
    summary.slowest.push_back({scene_->world().robots[i].name, waits[i].times_last, waits[i].waited_seconds});
  }
  std::stable_sort(summary.slowest.begin(), summary.slowest.end(),
                   [](const SlowRobot& a, const SlowRobot& b) { return a.waited_seconds > b.waited_seconds; });
  if (summary.slowest.size() > kSlowestListed) summary.slowest.resize(kSlowestListed);
  return summary;
}

}  // namespace troupe
