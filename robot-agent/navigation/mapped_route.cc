#include "robot-agent/navigation/mapped_route.h"

#include "robot-agent/navigation/evidence_grid.h"

namespace troupe {
namespace {

constexpr double kPlanInterval = 2.0;  // s
constexpr double kNear = 0.6;          // m: a point of the way within it is passed

}  // namespace

MappedRoute::MappedRoute(const RobotInfo& info, std::size_t ranger, const Settings& settings)
    : settings_(settings), ranger_(ranger), rays_(PlacedRaysOf(info, ranger)) {}

void MappedRoute::Observe(const Observation& observation) {
  if (!grid_) grid_.emplace(observation.pose_estimate.translation(), settings_.side, settings_.cell);
  const SensorReading& reading = observation.sensors[ranger_];
  if (reading.empty() || reading.tick != observation.tick) return;
  const Transform2 robot(observation.pose_estimate);
  grid_->Observe(observation.pose_estimate.translation(), {1.0, 0.0}, 0.0, false);  // the place of the robot is free
  for (const PlacedRay& placed : rays_) {
    const double range = RangeOf(reading, placed.ray);
    grid_->Observe(robot * placed.p_RO, robot.Rotate(placed.direction), range, range < placed.ray.max_range);
  }
}

bool MappedRoute::IsPlanDue(const Observation& observation) const {
  return planned_at_ < 0.0 || observation.time - planned_at_ >= kPlanInterval;
}

std::optional<Vec2> MappedRoute::FollowPath(const Observation& observation) {
  if (path_.empty()) return std::nullopt;
  const Vec2 here = observation.pose_estimate.translation();
  std::size_t passed = 0;
  for (std::size_t i = 0; i + 1 < path_.size(); ++i) {
    if ((path_[i] - here).squaredNorm() <= kNear * kNear) passed = i + 1;
  }
  path_.erase(path_.begin(), path_.begin() + static_cast<std::ptrdiff_t>(passed));
  return path_.front();
}

std::optional<Vec2> MappedRoute::NextPoint(const Observation& observation, const Vec2& goal, double reach) {
  const bool is_same = goal_ && (*goal_ - goal).squaredNorm() < settings_.cell * settings_.cell;
  if (!is_same || IsPlanDue(observation)) {
    path_ = PlanPath(*grid_, observation.pose_estimate.translation(), goal, reach, settings_.clearance)
                .value_or(std::vector<Vec2>());
    goal_ = goal;
    planned_at_ = observation.time;
  }
  return FollowPath(observation);
}

std::optional<Vec2> MappedRoute::NextUnknown(const Observation& observation) {
  // The last point is a place that was unknown: a new one follows as soon as it is seen.
  const std::optional<std::size_t> end = path_.empty() ? std::nullopt : grid_->IndexOf(path_.back());
  const bool is_seen = end && (*grid_)[*end] != EvidenceGrid::Cell::kUnknown;
  if (goal_ || is_seen || IsPlanDue(observation)) {
    path_ = PlanToUnknown(*grid_, observation.pose_estimate.translation(), settings_.clearance)
                .value_or(std::vector<Vec2>());
    goal_.reset();
    planned_at_ = observation.time;
  }
  return FollowPath(observation);
}

double MappedRoute::KnownArea() const {
  if (!grid_) return 0.0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < grid_->size(); ++i) {
    if ((*grid_)[i] != EvidenceGrid::Cell::kUnknown) ++known;
  }
  return static_cast<double>(known) * settings_.cell * settings_.cell;
}

}  // namespace troupe
