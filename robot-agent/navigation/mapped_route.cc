#include "robot-agent/navigation/mapped_route.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace troupe {
namespace {

constexpr double kPlanInterval = 2.0;  // s
constexpr double kNear = 0.6;          // m: a point of the way within it is passed

// Evidence of a ray: a hit counts for three passes, so that few rays past an edge do not erase it. The limit lets the
// map follow a door that opens.
constexpr int kHit = 3;
constexpr int kPass = -1;
constexpr int kMaxEvidence = 12;

using Cell = EvidenceGrid::Cell;

constexpr std::uint32_t kStraight = 10;  // cost of a step to a neighbour, and of a diagonal one
constexpr std::uint32_t kDiagonal = 14;
constexpr std::uint32_t kUnknownFactor = 2;
constexpr std::uint32_t kTightFactor = 20;  // nearer to an obstacle than the clearance
constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();

// The cells whose centres are within `clearance` m of that of an occupied one.
std::vector<bool> TightCells(const EvidenceGrid& grid, double clearance) {
  std::vector<bool> tight(grid.size(), false);
  const auto width = static_cast<std::int64_t>(grid.width());
  const auto radius = static_cast<std::int64_t>(std::ceil(clearance / grid.cell()));
  const double limit = clearance / grid.cell() * (clearance / grid.cell());
  std::vector<std::pair<std::int64_t, std::int64_t>> disc;
  for (std::int64_t y = -radius; y <= radius; ++y) {
    for (std::int64_t x = -radius; x <= radius; ++x) {
      if (static_cast<double>(x * x + y * y) <= limit) disc.emplace_back(x, y);
    }
  }
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid[i] != Cell::kOccupied) continue;
    const std::int64_t row = static_cast<std::int64_t>(i) / width;
    const std::int64_t column = static_cast<std::int64_t>(i) % width;
    for (const auto& [dx, dy] : disc) {
      const std::int64_t x = column + dx;
      const std::int64_t y = row + dy;
      if (x >= 0 && y >= 0 && x < width && y < width) tight[static_cast<std::size_t>(y * width + x)] = true;
    }
  }
  return tight;
}

struct Step {
  std::int64_t x;
  std::int64_t y;
  std::uint32_t cost;
};
constexpr std::array<Step, 8> kSteps = {{{1, 0, kStraight},
                                         {0, 1, kStraight},
                                         {-1, 0, kStraight},
                                         {0, -1, kStraight},
                                         {1, 1, kDiagonal},
                                         {-1, 1, kDiagonal},
                                         {-1, -1, kDiagonal},
                                         {1, -1, kDiagonal}}};

// The neighbour of a cell; nothing outside of the grid.
std::optional<std::size_t> NeighbourOf(const EvidenceGrid& grid, std::size_t cell, const Step& step) {
  const auto width = static_cast<std::int64_t>(grid.width());
  const std::int64_t x = static_cast<std::int64_t>(cell) % width + step.x;
  const std::int64_t y = static_cast<std::int64_t>(cell) / width + step.y;
  if (x < 0 || y < 0 || x >= width || y >= width) return std::nullopt;
  return static_cast<std::size_t>(y * width + x);
}

// Dijkstra's search; of equal costs the cell with the least index first, so that the way is always the same.
std::optional<std::vector<Vec2>> Search(const EvidenceGrid& grid, const Vec2& from, double clearance,
                                        bool through_unknown,
                                        const std::function<bool(std::size_t cell, bool tight)>& is_goal) {
  const std::optional<std::size_t> start = grid.IndexOf(from);
  if (!start) return std::nullopt;
  const std::vector<bool> tight = TightCells(grid, clearance);
  std::vector<std::uint32_t> costs(grid.size(), kNever);
  std::vector<std::uint32_t> previous(grid.size(), 0);
  using Entry = std::pair<std::uint32_t, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  costs[*start] = 0;
  open.emplace(0, *start);
  while (!open.empty()) {
    const auto [cost, cell] = open.top();
    open.pop();
    if (cost > costs[cell]) continue;
    if (is_goal(cell, tight[cell])) {
      std::vector<Vec2> path;
      for (std::size_t i = cell; i != *start; i = previous[i]) path.push_back(grid.CenterOf(i));
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (const Step& step : kSteps) {
      const std::optional<std::size_t> next = NeighbourOf(grid, cell, step);
      if (!next || grid[*next] == Cell::kOccupied) continue;
      const bool unknown = grid[*next] == Cell::kUnknown;
      if (unknown && !through_unknown) continue;
      const std::uint32_t factor = tight[*next] ? kTightFactor : unknown ? kUnknownFactor : 1;
      const std::uint32_t sum = cost + step.cost * factor;
      if (sum >= costs[*next]) continue;
      costs[*next] = sum;
      previous[*next] = static_cast<std::uint32_t>(cell);
      open.emplace(sum, *next);
    }
  }
  return std::nullopt;
}

}  // namespace

MappedRoute::MappedRoute(const RobotInfo& info, std::size_t ranger, const Settings& settings)
    : settings_(settings), ranger_(ranger), rays_(PlacedRaysOf(info, ranger)) {}

// The map is in the frame of the pose estimate: with odometry that drifts it is as wrong as that.
void MappedRoute::Observe(const Observation& observation) {
  if (!grid_) grid_.emplace(observation.pose_estimate.translation(), settings_.side, settings_.cell);
  const SensorReading& reading = observation.sensors[ranger_];
  if (reading.empty() || reading.tick != observation.tick) return;
  const Transform2 robot(observation.pose_estimate);
  grid_->Observe(observation.pose_estimate.translation(), {1.0, 0.0}, 0.0, false);  // the place of the robot is free
  for (const PlacedRay& placed : *rays_) {
    const double range = RangeOf(reading, placed.ray);
    grid_->Observe(robot * placed.p_RO, robot.Rotate(placed.direction), range, range < placed.ray.max_range);
  }
}

bool MappedRoute::IsPlanDue(const Observation& observation) const {
  return planned_at_ < 0.0 || observation.time - planned_at_ >= kPlanInterval;
}

// The farthest point that is near counts as passed, so that a robot that was pushed along does not turn back.
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

// Planned again in each interval, since the map has grown meanwhile.
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

EvidenceGrid::EvidenceGrid(const Vec2& center, double side, double cell)
    : corner_(center - Vec2(0.5 * side, 0.5 * side)),
      cell_(cell),
      width_(static_cast<std::size_t>(std::ceil(side / cell))),
      evidence_(width_ * width_, 0) {}

std::optional<std::size_t> EvidenceGrid::IndexOf(const Vec2& point) const {
  const Vec2 place = (point - corner_) / cell_;
  const double width = static_cast<double>(width_);
  if (!(place.x() >= 0.0 && place.y() >= 0.0 && place.x() < width && place.y() < width)) return std::nullopt;
  return static_cast<std::size_t>(place.y()) * width_ + static_cast<std::size_t>(place.x());
}

Vec2 EvidenceGrid::CenterOf(std::size_t index) const {
  const std::size_t row = index / width_;
  return corner_ + cell_ * Vec2(static_cast<double>(index % width_) + 0.5, static_cast<double>(row) + 0.5);
}

void EvidenceGrid::Add(std::size_t index, int evidence) {
  int sum = std::clamp(evidence_[index] + evidence, -kMaxEvidence, kMaxEvidence);
  // A cell that was seen never becomes unknown again: the robot would drive there once more.
  if (sum == 0) sum = evidence > 0 ? 1 : -1;  // 0: never seen
  evidence_[index] = static_cast<std::int8_t>(sum);
}

void EvidenceGrid::Observe(const Vec2& origin, const Vec2& direction, double range, bool hit) {
  const std::optional<std::size_t> end = hit ? IndexOf(origin + range * direction) : std::nullopt;
  std::optional<std::size_t> last;
  // Half cells: a ray skips no cell by more than a corner.
  const double step = 0.5 * cell_;
  const auto count = static_cast<std::size_t>(range / step);
  for (std::size_t i = 0; i <= count; ++i) {
    const std::optional<std::size_t> index = IndexOf(origin + (static_cast<double>(i) * step) * direction);
    if (!index || index == last || index == end) continue;
    last = index;
    Add(*index, kPass);
  }
  if (end) Add(*end, kHit);
}

// Through unknown cells at a higher cost: they may be free.
std::optional<std::vector<Vec2>> PlanPath(const EvidenceGrid& grid, const Vec2& from, const Vec2& goal, double reach,
                                          double clearance) {
  if (!grid.IndexOf(goal)) return std::nullopt;
  const double limit = std::max(reach, grid.cell()) * std::max(reach, grid.cell());
  return Search(grid, from, clearance, true,
                [&](std::size_t cell, bool) { return (grid.CenterOf(cell) - goal).squaredNorm() <= limit; });
}

// The nearest known cell beside an unknown one (frontier exploration, Yamauchi 1997).
std::optional<std::vector<Vec2>> PlanToUnknown(const EvidenceGrid& grid, const Vec2& from, double clearance) {
  std::size_t unknown = 0;
  std::optional<std::vector<Vec2>> path = Search(grid, from, clearance, false, [&](std::size_t cell, bool tight) {
    if (tight) return false;
    return std::any_of(kSteps.begin(), kSteps.begin() + 4, [&](const Step& step) {
      const std::optional<std::size_t> next = NeighbourOf(grid, cell, step);
      if (!next || grid[*next] != Cell::kUnknown) return false;
      unknown = *next;
      return true;
    });
  });
  if (path) path->push_back(grid.CenterOf(unknown));
  return path;
}

}  // namespace troupe
