#include "common/spatial/way_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "common/spatial/zone_ways.h"

namespace troupe {
namespace {

constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint8_t kNoStepBack = 0xff;
constexpr double kLeave = 0.3;             // m, around the start: a robot beside a body may leave it
constexpr std::size_t kLongestLine = 400;  // cells
constexpr double kRoomReach = 6.0;         // m, to all sides of a robot that wants to pass
constexpr double kBetweenTries = 0.3;      // m, between places that are tried
constexpr std::size_t kMaxTries = 60;

// The cell of a goal; nothing where there is no room. The radius of a grid is rounded, so that a goal may be a little
// beside the free cells.
std::optional<std::size_t> CellOfGoal(const WalkGrid& grid, const Vec2& goal) {
  const std::optional<std::size_t> cell = grid.Nearest(goal, [&](std::size_t c) { return grid.IsFree(c); });
  if (!cell || grid.CellOf(goal) == *cell) return cell;
  const double slack = 0.5 * grid.radius() + grid.cell();
  return (grid.CenterOf(*cell) - goal).norm() <= slack ? cell : std::nullopt;
}

class WaySearch {
 public:
  WaySearch(const WalkGrid& grid, std::span<const ConvexPiece* const> standing, const ZoneWays* zones)
      : grid_(grid), zones_(zones != nullptr && !zones->empty() ? zones : nullptr) {
    if (!standing.empty()) taken_.resize(grid.cell_count(), false);
    for (const ConvexPiece* const piece : standing) grid.MarkTaken(*piece, taken_);
  }

  // To `to`.
  Result<Way> Find(const Vec2& from, const Vec2& to) {
    const std::optional<std::size_t> start = StartAt(from);
    if (!start) return Failure("nothing around the robot is free");
    const std::optional<std::size_t> end = CellOfGoal(grid_, to);
    if (!end) return Failure("there is no room for the robot");
    if (zones_ != nullptr && zones_->IsClosed(*end))
      return Failure("it is in a keepout zone that is on, or too near to one");
    std::optional<std::size_t> target = end;
    if (IsTaken(*end)) {
      target = grid_.Nearest(to, [&](std::size_t cell) { return IsOpen(cell) && !IsTaken(cell); });
    }
    if (!target || !Search(
                       *start, [&](std::size_t cell) { return cell == *target; },
                       [&](std::size_t cell) { return Estimate(cell, *target); })) {
      return Failure(zones_ == nullptr ? "no way leads there" : "no way leads there that the zones allow");
    }
    Way way{.reaches = target == end};
    way.points = Straighten(from, *start, *target);
    if (way.reaches) way.points.back() = grid_.Contains(to) ? to : way.points.back();
    if (way.reaches && !grid_.Contains(to)) way.points.push_back(to);
    return way;
  }

  // To the nearest cell that accept(cell).
  template <typename Accept>
  Result<Way> FindNearest(const Vec2& from, Accept accept) {
    const std::optional<std::size_t> start = StartAt(from);
    const auto estimate = [](std::size_t) { return std::uint32_t{0}; };
    const std::optional<std::size_t> end = start ? Search(*start, accept, estimate) : std::nullopt;
    if (!end) return Failure("no such place can be reached");
    return Way{Straighten(from, *start, *end)};
  }

 private:
  // A robot that touches a wall is beside the free cells.
  std::optional<std::size_t> StartAt(const Vec2& from) {
    const std::optional<std::size_t> start = grid_.Nearest(from, [&](std::size_t cell) { return grid_.IsFree(cell); });
    if (start && !taken_.empty()) Leave(grid_.CenterOf(*start));
    return start;
  }

  bool IsTaken(std::size_t cell) const { return !taken_.empty() && taken_[cell]; }
  bool IsOpen(std::size_t cell) const { return grid_.IsFree(cell) && (zones_ == nullptr || !zones_->IsClosed(cell)); }
  // A straight way on which a robot may drive.
  bool IsClear(const Vec2& from, const Vec2& to) const {
    if (!grid_.IsClear(from, to, taken_)) return false;
    return zones_ == nullptr || (zones_->MayDrive(from, to) && grid_.IsClear(from, to, zones_->closed()));
  }

  // Cells around the start are free of bodies: one that stands so near is no reason to stay.
  void Leave(const Vec2& start) {
    const int reach = static_cast<int>(kLeave / grid_.cell()) + 1;
    const int rows = static_cast<int>(grid_.cell_count()) / grid_.columns();
    const int column = grid_.ColumnAt(start.x());
    const int row = grid_.RowAt(start.y());
    for (int r = std::max(0, row - reach); r <= std::min(rows - 1, row + reach); ++r) {
      for (int c = std::max(0, column - reach); c <= std::min(grid_.columns() - 1, column + reach); ++c) {
        const std::size_t cell = grid_.CellAt(c, r);
        if ((grid_.CenterOf(cell) - start).norm() <= kLeave) taken_[cell] = false;
      }
    }
  }

  // The length of a way over free cells alone.
  std::uint32_t Estimate(std::size_t cell, std::size_t target) const {
    const auto columns = static_cast<std::uint32_t>(std::abs(grid_.ColumnOf(cell) - grid_.ColumnOf(target)));
    const auto rows = static_cast<std::uint32_t>(std::abs(grid_.RowOf(cell) - grid_.RowOf(target)));
    const std::uint32_t both = std::min(columns, rows);
    return WalkGrid::kDiagonal * both + WalkGrid::kStraight * (std::max(columns, rows) - both);
  }

  // The first cell that is_end(cell), in the order of whole lengths; estimate(cell) is at most the length from there.
  template <typename IsEnd, typename Estimated>
  std::optional<std::size_t> Search(std::size_t start, IsEnd is_end, Estimated estimate) {
    lengths_.assign(grid_.cell_count(), kUnreached);
    steps_.assign(grid_.cell_count(), kNoStepBack);
    using Entry = std::pair<std::uint32_t, std::size_t>;  // the estimated length of the whole way, and the cell
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    lengths_[start] = 0;
    open.emplace(estimate(start), start);
    while (!open.empty()) {
      const std::uint32_t whole = open.top().first;
      const std::size_t cell = open.top().second;
      open.pop();
      if (is_end(cell)) return cell;
      if (whole > lengths_[cell] + estimate(cell)) continue;  // it was found on a shorter way
      grid_.ForEachStep(cell, [&](std::size_t to, std::size_t number) {
        if (IsTaken(to) || (zones_ != nullptr && !zones_->MayStep(cell, to, number))) return;
        const std::uint32_t cost = grid_.CostOf(to) * (zones_ == nullptr ? 1 : zones_->CostOf(to));
        const std::uint32_t length = lengths_[cell] + WalkGrid::kSteps[number].length * cost;
        if (length >= lengths_[to]) return;
        lengths_[to] = length;
        steps_[to] = static_cast<std::uint8_t>(number);
        open.emplace(length + estimate(to), to);
      });
    }
    return std::nullopt;
  }

  // The centres of the cells at which the way turns, and of the target.
  std::vector<Vec2> Straighten(const Vec2& from, std::size_t start, std::size_t target) const {
    std::vector<std::size_t> cells;
    for (std::size_t cell = target; cell != start;) {
      cells.push_back(cell);
      const WalkGrid::Step& step = WalkGrid::kSteps[steps_[cell]];
      cell = grid_.CellAt(grid_.ColumnOf(cell) - step.columns, grid_.RowOf(cell) - step.rows);
    }
    cells.push_back(start);
    std::reverse(cells.begin(), cells.end());
    std::vector<Vec2> points;
    Vec2 here = from;
    if (grid_.CellOf(from) != start || !grid_.Contains(from)) points.push_back(here = grid_.CenterOf(start));
    for (std::size_t at = 0; at + 1 < cells.size();) {
      std::size_t ahead = std::min(kLongestLine, cells.size() - 1 - at);
      while (ahead > 1 && !IsClear(here, grid_.CenterOf(cells[at + ahead]))) ahead = ahead * 3 / 4;
      at += ahead;
      points.push_back(here = grid_.CenterOf(cells[at]));
    }
    if (points.empty()) points.push_back(grid_.CenterOf(target));
    return points;
  }

  const WalkGrid& grid_;
  const ZoneWays* zones_;    // null: none that limits ways
  std::vector<bool> taken_;  // by cell; empty: none
  std::vector<std::uint32_t> lengths_;
  std::vector<std::uint8_t> steps_;  // by cell, in WalkGrid::kSteps: the last one of its way
};

// The cells that a robot can reach within a square around it.
class OtherRobot {
 public:
  OtherRobot(const WalkGrid& grid, const Vec2& at)
      : grid_(grid), at_(at), start_(grid.Nearest(at, [&](std::size_t cell) { return grid.IsFree(cell); })) {}

  // The cells that are reached, and those within `distance` m of `place`, through which no way leads; null: of nothing.
  std::size_t CountReached(const Vec2* place, double distance) const {
    if (!start_) return 0;
    const auto is_taken = [&](std::size_t cell) {
      return place != nullptr && (grid_.CenterOf(cell) - *place).squaredNorm() < distance * distance;
    };
    std::vector<bool> seen(grid_.cell_count(), false);
    std::vector<std::size_t> open = {*start_};
    seen[*start_] = true;
    std::size_t count = 0;
    while (!open.empty()) {
      const std::size_t cell = open.back();
      open.pop_back();
      ++count;
      if (is_taken(cell)) continue;  // reached beside the place, but no way leads on
      grid_.ForEachStep(cell, [&](std::size_t to, std::size_t) {
        const Vec2 from_start = grid_.CenterOf(to) - at_;
        if (seen[to] || from_start.cwiseAbs().maxCoeff() > kRoomReach) return;
        seen[to] = true;
        open.push_back(to);
      });
    }
    return count + (place == nullptr ? 0 : CountUnseen(*place, distance, seen));
  }

 private:
  // Free cells at the place that no step has reached: they are of the robot that stands there.
  std::size_t CountUnseen(const Vec2& place, double distance, const std::vector<bool>& seen) const {
    std::size_t count = 0;
    for (int row = grid_.RowAt(place.y() - distance); row <= grid_.RowAt(place.y() + distance); ++row) {
      for (int column = grid_.ColumnAt(place.x() - distance); column <= grid_.ColumnAt(place.x() + distance);
           ++column) {
        const std::size_t cell = grid_.CellAt(column, row);
        count += grid_.IsFree(cell) && !seen[cell] && (grid_.CenterOf(cell) - place).norm() < distance;
      }
    }
    return count;
  }

  const WalkGrid& grid_;
  Vec2 at_;
  std::optional<std::size_t> start_;
};

}  // namespace

Result<Way> FindWay(const WalkGrid& grid, const Vec2& from, const Vec2& to,
                    std::span<const ConvexPiece* const> standing, const ZoneWays* zones) {
  return WaySearch(grid, standing, zones).Find(from, to);
}

Status CheckWays(const WalkGrid& grid, const Vec2& from, std::span<const Vec2> points) {
  const WalkField reached(grid, from);
  if (!reached.target()) return {};  // a robot in a narrow place tries
  for (const Vec2& point : points) {
    const std::optional<std::size_t> cell = CellOfGoal(grid, point);
    if (!cell) return Failure(fmt::format("there is no room for it at ({:.2f}, {:.2f})", point.x(), point.y()));
    if (!reached.ReachesCell(*cell)) {
      return Failure(fmt::format("no way leads to ({:.2f}, {:.2f})", point.x(), point.y()));
    }
  }
  return {};
}

Result<Way> FindRoom(const WalkGrid& grid, const Vec2& from, const RoomFor& room,
                     std::span<const ConvexPiece* const> standing, const ZoneWays* zones) {
  const OtherRobot other(room.of_other, room.other);
  const std::size_t reached = other.CountReached(nullptr, 0.0);
  std::vector<Vec2> tried;
  return WaySearch(grid, standing, zones).FindNearest(from, [&](std::size_t cell) {
    const Vec2 place = grid.CenterOf(cell);
    if (zones != nullptr && zones->IsClosed(cell)) return false;
    const bool is_near = std::any_of(tried.begin(), tried.end(),
                                     [&](const Vec2& before) { return (place - before).norm() < kBetweenTries; });
    if (is_near || tried.size() == kMaxTries) return false;
    tried.push_back(place);
    return 50 * other.CountReached(&place, room.own_radius + room.of_other.radius()) >= 49 * reached;
  });
}

}  // namespace troupe
