#include "world-service/service/trip_totals.h"

#include <algorithm>

#include "common/model/lane_trips.h"

namespace troupe {

Status TripTotals::OnBegin(const RunStart& start) {
  scene_ = start.scene;
  return {};
}

void TripTotals::OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition) {
  scene_ = scene;
}

Status TripTotals::OnTick(const CommittedTick& tick) {
  const std::vector<LaneTrip>& trips = scene_->world().lane_trips;
  if (trips.empty()) return {};
  const WorldState& state = tick.frame.state;
  const bool begins = tick.edit != nullptr && tick.frame.fresh_edition == tick.frame.edition;
  if (begins || !since_ || trips_.size() != trips.size()) {
    trips_.assign(trips.size(), {});
    since_ = state.tick;
  }
  now_ = state.tick;
  for (std::size_t i = 0; i < trips.size(); ++i) {
    const TrafficRobot* const robot = FindTrafficRobot(state.traffic_robots, trips[i].robot);
    if (robot == nullptr) continue;
    const std::vector<std::uint32_t>& goals = trips[i].goals;
    Progress& progress = trips_[i];
    if (progress.visited < goals.size() && robot->at == goals[progress.visited]) ++progress.visited;
    const bool is_there = progress.visited == goals.size() && (goals.empty() || robot->at == goals.back());
    if (!is_there) {
      progress.arrived_at.reset();
    } else if (!progress.arrived_at) {
      progress.arrived_at = state.tick;
    }
  }
  return {};
}

std::optional<TripSummary> TripTotals::Collect() const {
  if (trips_.empty() || !since_) return std::nullopt;
  TripSummary summary;
  const double interval = scene_->world().interval_seconds();
  summary.robots = trips_.size();
  for (const Progress& progress : trips_) {
    summary.goals += progress.visited;
    if (!progress.arrived_at) continue;
    ++summary.arrived;
    const double seconds = static_cast<double>(*progress.arrived_at - *since_) * interval;
    summary.makespan = std::max(summary.makespan, seconds);
    summary.flow_time += seconds;
  }
  const double seconds = static_cast<double>(now_ - *since_) * interval;
  if (seconds > 0.0) summary.throughput = static_cast<double>(summary.goals) / seconds;
  return summary;
}

}  // namespace troupe
