#include "common/spatial/walk_grid.h"

#include <algorithm>

namespace troupe {
namespace {

constexpr double kMaxWalkCell = 0.25;     // m
constexpr double kManyCells = 400'000.0;  // with more, cells are coarser
constexpr double kMaxGridCells = 16e6;
constexpr double kComfort = 0.2;  // m: a cell so near to a wall counts twice

// Numbers of steps, and two more.
constexpr std::uint8_t kUnknown = 0xff;  // not looked for so far

// m, of a cell.
double SideOf(const Rectangle& bounds, double min_cell) {
  const double area = bounds.width() * bounds.height();
  return std::max(std::clamp(std::sqrt(area / kManyCells), min_cell, kMaxWalkCell), std::sqrt(area / kMaxGridCells));
}

std::size_t CountOf(double length, double cell) {
  return static_cast<std::size_t>(length / cell) + 1;
}

}  // namespace

std::size_t WalkGrid::CountCells(const Rectangle& bounds) {
  const double cell = SideOf(bounds, kMinCell);
  return CountOf(bounds.width(), cell) * CountOf(bounds.height(), cell);
}

WalkGrid::WalkGrid(const StaticIndex& walls, const WalkPortals& portals, const ZRange& z, double radius,
                   const Rectangle& bounds, double min_cell)
    : z_(z), radius_(radius), bounds_(bounds), cell_(SideOf(bounds, min_cell)) {
  columns_ = static_cast<int>(CountOf(bounds.width(), cell_));
  rows_ = static_cast<int>(CountOf(bounds.height(), cell_));
  room_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), Room::kFree);
  walls.ForEachPiece([&](const ConvexPiece& piece) { Block(piece); });
  for (const ConvexPiece& wall : portals.walls) Block(wall);
  for (const ConvexPiece& leaf : portals.open_leaves) {
    if (!leaf.obstacle || !leaf.z.Overlaps(z_)) continue;
    ForEachNear(leaf, radius_, [&](std::size_t cell, double) { room_[cell] = Room::kAtLeaf; });
  }
  for (std::size_t i = 0; i < portals.doors.size(); ++i) {
    if (!portals.doors[i]) continue;
    for (const ConvexPiece& leaf : portals.doors[i]->closed) {
      if (!leaf.obstacle || !leaf.z.Overlaps(z_)) continue;
      door_.resize(room_.size(), 0);
      ForEachNear(leaf, radius_, [&](std::size_t cell, double) {
        // Of two doors at one cell the first.
        if (door_[cell] == 0) door_[cell] = static_cast<std::uint32_t>(i + 1);
      });
    }
  }
}

template <typename Visit>
void WalkGrid::ForEachNear(const ConvexPiece& piece, double reach, Visit visit) const {
  const Rectangle box = BoundingBox(piece.vertices).Inflated(reach);
  if (!box.Overlaps(bounds_)) return;
  for (int row = RowAt(box.min_y); row <= RowAt(box.max_y); ++row) {
    for (int column = ColumnAt(box.min_x); column <= ColumnAt(box.max_x); ++column) {
      const std::size_t cell = CellAt(column, row);
      // A blocked cell stays so: the most is known of it.
      if (room_[cell] == Room::kBlocked) continue;
      const Vec2 center = CenterOf(cell);
      const double distance = FindNearestPoints(std::span(&center, 1), piece.vertices).distance;
      if (distance < reach) visit(cell, distance);
    }
  }
}

void WalkGrid::Block(const ConvexPiece& piece) {
  if (!piece.obstacle || !piece.z.Overlaps(z_)) return;
  ForEachNear(piece, radius_ + kComfort, [&](std::size_t cell, double distance) {
    // In any order of pieces the result is the same: blocked wins over near.
    room_[cell] = distance < radius_ ? Room::kBlocked : Room::kNearWall;
  });
}

bool WalkGrid::IsClear(const Vec2& from, const Vec2& to, const std::vector<bool>& taken) const {
  const Vec2 way = to - from;
  // Half a cell at a time: no cell is skipped by more than a corner.
  const int parts = static_cast<int>(2.0 * way.norm() / cell_) + 1;
  for (int i = 1; i <= parts; ++i) {
    const std::size_t cell = CellOf(from + (static_cast<double>(i) / parts) * way);
    if (room_[cell] == Room::kBlocked || room_[cell] == Room::kAtLeaf || (!taken.empty() && taken[cell])) return false;
  }
  return true;
}

void WalkGrid::MarkTaken(const ConvexPiece& piece, std::vector<bool>& taken) const {
  if (!piece.obstacle || !piece.z.Overlaps(z_)) return;
  ForEachNear(piece, radius_, [&](std::size_t cell, double) { taken[cell] = true; });
}

// The costs of the cells of a grid, with a border of blocked cells around them, so that a step needs no look at columns
// and rows: that takes a third of the time.
class WalkField::Costs {
 public:
  static constexpr std::uint8_t kBlocked = 0;

  explicit Costs(const WalkGrid& grid)
      : columns_(static_cast<std::size_t>(grid.columns())),
        width_(columns_ + 2),
        costs_(width_ * (grid.cell_count() / columns_ + 2), kBlocked) {
    for (std::size_t cell = 0; cell < grid.cell_count(); ++cell) {
      if (grid.IsFree(cell)) costs_[PlaceOf(cell)] = static_cast<std::uint8_t>(grid.CostOf(cell));
    }
    for (std::size_t i = 0; i < offsets_.size(); ++i) offsets_[i] = OffsetOf(WalkGrid::kSteps[i]);
  }

  std::size_t size() const { return costs_.size(); }
  std::size_t PlaceOf(std::size_t cell) const { return (cell / columns_ + 1) * width_ + cell % columns_ + 1; }

  // Calls visit(place, length of the step) as WalkGrid::ForEachStep, without places for which `is_done`.
  template <typename IsDone, typename Visit>
  void ForEachStep(std::size_t place, IsDone is_done, Visit visit) const {
    for (std::size_t i = 0; i < offsets_.size(); ++i) {
      const WalkGrid::Step& step = WalkGrid::kSteps[i];
      const std::size_t to = place + offsets_[i];
      if (is_done(to) || costs_[to] == kBlocked) continue;
      if (step.length == WalkGrid::kDiagonal && (costs_[place + OffsetOf({step.columns, 0, 0})] == kBlocked ||
                                                 costs_[place + OffsetOf({0, step.rows, 0})] == kBlocked)) {
        continue;
      }
      visit(to, step.length * costs_[to]);
    }
  }

 private:
  // To be added, modulo the size of all numbers.
  std::size_t OffsetOf(const WalkGrid::Step& step) const {
    return static_cast<std::size_t>(step.rows) * width_ + static_cast<std::size_t>(step.columns);
  }

  const std::size_t columns_;
  const std::size_t width_;
  std::vector<std::uint8_t> costs_;
  std::array<std::size_t, WalkGrid::kSteps.size()> offsets_{};
};

// Dijkstra's algorithm with a list for each length that may be in it: lengths are small numbers.
void WalkField::MeasureLengths(std::size_t target) {
  const Costs costs(grid_);
  std::vector<std::uint32_t> lengths(costs.size(), kUnreached);
  // A circular queue of buckets (Dial 1969): no entry is farther ahead than the longest step.
  std::array<std::vector<std::uint32_t>, WalkGrid::kMaxCost * WalkGrid::kDiagonal + 1> lists;
  const std::size_t first = costs.PlaceOf(target);
  lengths[first] = 0;
  lists[0].push_back(static_cast<std::uint32_t>(first));
  std::size_t waiting = 1;
  for (std::uint32_t at = 0; waiting > 0; ++at) {
    std::vector<std::uint32_t>& list = lists[at % lists.size()];
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::size_t from = list[i];
      --waiting;
      if (lengths[from] != at) continue;  // it was found on a shorter way
      const auto is_done = [&](std::size_t to) { return lengths[to] <= at; };
      costs.ForEachStep(from, is_done, [&](std::size_t to, std::uint32_t length) {
        const std::uint32_t there = at + length;
        if (there >= lengths[to]) return;
        lengths[to] = there;
        lists[there % lists.size()].push_back(static_cast<std::uint32_t>(to));
        ++waiting;
      });
    }
    list.clear();
  }
  length_.resize(grid_.cell_count());
  for (std::size_t cell = 0; cell < length_.size(); ++cell) length_[cell] = lengths[costs.PlaceOf(cell)];
}

WalkField::WalkField(const WalkGrid& grid, const Vec2& goal) : grid_(grid) {
  const std::optional<std::size_t> cell = grid.Nearest(goal, [&](std::size_t c) { return grid.IsFree(c); });
  if (!cell) return;
  target_ = grid.CellOf(goal) == *cell ? goal : grid.CenterOf(*cell);
  MeasureLengths(*cell);
  // A doorway is as deep as a person is wide, at least, so that such a stride ends in it.
  if (grid_.has_doors() && kStride * grid_.cell() > 2.0 * grid_.radius()) stride_ = 1;
  strides_ = std::vector<std::atomic<std::uint8_t>>(length_.size());
  for (std::atomic<std::uint8_t>& stride : strides_) stride.store(kUnknown, std::memory_order_relaxed);
}

std::size_t WalkField::NextCell(std::size_t cell) const {
  std::size_t next = cell;
  std::uint32_t least = length_[cell];
  grid_.ForEachStep(cell, [&](std::size_t to, std::size_t) {
    if (length_[to] >= least) return;
    least = length_[to];
    next = to;
  });
  return next;
}

std::size_t WalkField::SharedStart(std::size_t cell) const {
  const int column = grid_.ColumnOf(cell) / stride_ * stride_ + stride_ / 2;
  const int row = grid_.RowOf(cell) / stride_ * stride_ + stride_ / 2;
  if (stride_ == 1 || column >= grid_.columns() || row >= grid_.rows()) return cell;
  const std::size_t shared = grid_.CellAt(column, row);
  return length_[shared] == kUnreached || grid_.DoorOf(cell) || grid_.DoorOf(shared) ? cell : shared;
}

std::size_t WalkField::CellAhead(std::size_t cell) const {
  constexpr int kWidth = 2 * kStride + 1;
  std::uint8_t stride = strides_[cell].load(std::memory_order_relaxed);
  if (stride == kUnknown) {
    std::size_t to = cell;
    for (int i = 0; i < stride_; ++i) to = NextCell(to);
    const int columns = grid_.ColumnOf(to) - grid_.ColumnOf(cell) + kStride;
    const int rows = grid_.RowOf(to) - grid_.RowOf(cell) + kStride;
    stride = static_cast<std::uint8_t>(rows * kWidth + columns);
    // Two threads may both find it: they store the same number.
    strides_[cell].store(stride, std::memory_order_relaxed);
  }
  return grid_.Beside(cell, stride % kWidth - kStride, stride / kWidth - kStride);
}

}  // namespace troupe
