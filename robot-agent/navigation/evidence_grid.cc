#include "robot-agent/navigation/evidence_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace troupe {
namespace {

constexpr int kHit = 3;
constexpr int kPass = -1;
constexpr int kMostEvidence = 12;

using Cell = EvidenceGrid::Cell;

constexpr std::uint32_t kStraight = 10;  // cost of a step to a neighbour, and of a diagonal one
constexpr std::uint32_t kDiagonal = 14;
constexpr std::uint32_t kUnknownFactor = 2;
constexpr std::uint32_t kTightFactor = 20;  // nearer to an obstacle than the clearance
constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();

// The cells within `clearance` m of an occupied one.
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
  int sum = std::clamp(evidence_[index] + evidence, -kMostEvidence, kMostEvidence);
  if (sum == 0) sum = evidence > 0 ? 1 : -1;  // 0: never seen
  evidence_[index] = static_cast<std::int8_t>(sum);
}

void EvidenceGrid::Observe(const Vec2& origin, const Vec2& direction, double range, bool hit) {
  const std::optional<std::size_t> end = hit ? IndexOf(origin + range * direction) : std::nullopt;
  std::optional<std::size_t> last;
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

std::optional<std::vector<Vec2>> PlanPath(const EvidenceGrid& grid, const Vec2& from, const Vec2& goal, double reach,
                                          double clearance) {
  if (!grid.IndexOf(goal)) return std::nullopt;
  const double limit = std::max(reach, grid.cell()) * std::max(reach, grid.cell());
  return Search(grid, from, clearance, true,
                [&](std::size_t cell, bool) { return (grid.CenterOf(cell) - goal).squaredNorm() <= limit; });
}

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
