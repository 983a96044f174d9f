// WalkGrid: the cells of a level in which people or robots of one size fit, and the steps between them. WalkField: the
// shortest way from every cell to a goal.
//
// Cells have a side of 0.1 to 0.25 m, less for small robots, more in a very large world, and are free if the centre of
// the body may be at their centre. Lengths are whole numbers, 10 for a straight step and 14 for a diagonal one, times
// the cost of the cell: sums are exact, so that equal ways are equal and the first of them is chosen on every machine.
// Cells near walls cost twice as much, and the leaves of open doors eight times: people keep away from both where there
// is room.
//
// A field is made by one Dijkstra search from its goal (Dijkstra 1959), in time linear in the cells, and then serves
// all people with that goal: a crowd of any size looks its next steps up. Searching a way for each person alone (A*)
// would cost more from a few people on, and again in each tick.
//
// Both are constant after construction, apart from remembered strides, which are atomic and pure functions of the
// lengths. Doors count as open for the search: a way through a closed door is found, and the person asks for the door.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/static_index.h"
#include "common/spatial/walk_portals.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"

namespace troupe {

class WalkGrid {
 public:
  static constexpr std::uint32_t kStraight = 10;  // the length of a step to the side of a cell
  static constexpr std::uint32_t kDiagonal = 14;
  struct Step {
    int columns;
    int rows;
    std::uint32_t length;
  };
  static constexpr std::array kSteps{Step{1, 0, kStraight},   Step{0, 1, kStraight}, Step{-1, 0, kStraight},
                                     Step{0, -1, kStraight},  Step{1, 1, kDiagonal}, Step{-1, 1, kDiagonal},
                                     Step{-1, -1, kDiagonal}, Step{1, -1, kDiagonal}};

  // The cells of a grid with these bounds: of a wide one they are larger.
  static std::size_t CountCells(const Rectangle& bounds);
  // The bytes of memory for each cell of a grid, and of a field, at most.
  static constexpr std::size_t kBytesOfCell = 5;

  static constexpr double kMinCell = 0.1;  // m, for people

  // Of bodies at the heights `z` (m, W) with a radius; cells are not smaller than `min_cell` (m).
  WalkGrid(const StaticIndex& walls, const WalkPortals& portals, const ZRange& z, double radius,
           const Rectangle& bounds, double min_cell = kMinCell);

  std::size_t cell_count() const { return room_.size(); }
  bool has_doors() const { return !door_.empty(); }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double cell() const { return cell_; }
  double radius() const { return radius_; }
  bool IsFree(std::size_t cell) const { return room_[cell] != Room::kBlocked; }
  static constexpr std::uint32_t kMaxCost = 8;
  std::uint32_t CostOf(std::size_t cell) const {
    return room_[cell] == Room::kAtLeaf ? kMaxCost : room_[cell] == Room::kNearWall ? 2 : 1;
  }
  // The door in whose doorway the cell is: a person there touches its leaves while they are closed.
  std::optional<std::size_t> DoorOf(std::size_t cell) const {
    if (door_.empty() || door_[cell] == 0) return std::nullopt;
    return door_[cell] - std::size_t{1};
  }
  std::size_t CellAt(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int ColumnOf(std::size_t cell) const { return static_cast<int>(cell % static_cast<std::size_t>(columns_)); }
  int RowOf(std::size_t cell) const { return static_cast<int>(cell / static_cast<std::size_t>(columns_)); }
  bool Contains(const Vec2& p) const {
    return p.x() >= bounds_.min_x && p.x() <= bounds_.max_x && p.y() >= bounds_.min_y && p.y() <= bounds_.max_y;
  }
  // Points beyond the grid belong to the nearest cell.
  int ColumnAt(double x) const { return Clamped((x - bounds_.min_x) / cell_, columns_); }
  int RowAt(double y) const { return Clamped((y - bounds_.min_y) / cell_, rows_); }
  std::size_t CellOf(const Vec2& p) const { return CellAt(ColumnAt(p.x()), RowAt(p.y())); }
  Vec2 CenterOf(std::size_t cell) const {
    return {bounds_.min_x + (ColumnOf(cell) + 0.5) * cell_, bounds_.min_y + (RowOf(cell) + 0.5) * cell_};
  }

  // The cell nearest to `p` for which accept(cell), within kDetour; of equally near ones the first.
  template <typename Accept>
  std::optional<std::size_t> Nearest(const Vec2& p, Accept accept) const {
    if (const std::size_t own = CellOf(p); accept(own)) return own;
    const int reach = static_cast<int>(kDetour / cell_);
    const int column = ColumnAt(p.x());
    const int row = RowAt(p.y());
    std::optional<std::size_t> best;
    double least = kDetour * kDetour;
    for (int r = std::max(0, row - reach); r <= std::min(rows_ - 1, row + reach); ++r) {
      for (int c = std::max(0, column - reach); c <= std::min(columns_ - 1, column + reach); ++c) {
        const std::size_t cell = CellAt(c, r);
        const double square = (CenterOf(cell) - p).squaredNorm();
        if (square >= least || !accept(cell)) continue;
        best = cell;
        least = square;
      }
    }
    return best;
  }

  // The cell so many columns and rows farther. REQUIRES: there is one.
  std::size_t Beside(std::size_t cell, int columns, int rows) const {
    return cell + static_cast<std::size_t>(rows * std::ptrdiff_t{columns_} + columns);
  }

  // Calls visit(cell, number of the step) for the free neighbours, never across the corner of a blocked cell.
  template <typename Visit>
  void ForEachStep(std::size_t cell, Visit visit) const {
    const int column = ColumnOf(cell);
    const int row = RowOf(cell);
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
      const Step& step = kSteps[i];
      const int c = column + step.columns;
      const int r = row + step.rows;
      if (c < 0 || r < 0 || c >= columns_ || r >= rows_ || !IsFree(CellAt(c, r))) continue;
      if (step.length == kDiagonal && (!IsFree(CellAt(c, row)) || !IsFree(CellAt(column, r)))) continue;
      visit(CellAt(c, r), i);
    }
  }

  // All cells between the points are free, not at the leaf of an open door, and not marked in `taken` (by cell; empty:
  // none is).
  bool IsClear(const Vec2& from, const Vec2& to, const std::vector<bool>& taken = {}) const;

  // Marks in `taken`, by cell, where a piece (in W) that stands there now leaves no room.
  void MarkTaken(const ConvexPiece& piece, std::vector<bool>& taken) const;

 private:
  enum class Room : std::uint8_t { kFree, kNearWall, kAtLeaf, kBlocked };

  static constexpr double kDetour = 1.5;  // m: a target is at most so far from its goal

  static int Clamped(double at, int count) { return !(at > 0.0) ? 0 : at >= count ? count - 1 : static_cast<int>(at); }
  // Calls visit(cell, distance) for the cells within `reach` m of a piece.
  template <typename Visit>
  void ForEachNear(const ConvexPiece& piece, double reach, Visit visit) const;
  void Block(const ConvexPiece& piece);

  const ZRange z_;
  const double radius_;
  Rectangle bounds_;
  double cell_ = 0.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Room> room_;
  std::vector<std::uint32_t> door_;  // by cell: the number of its door from 1 on; 0: none; empty without doors
};

class WalkField {
 public:
  WalkField(const WalkGrid& grid, const Vec2& goal);

  const WalkGrid& grid() const { return grid_; }
  // The place nearest to the goal at which a person can stand: mostly the goal itself.
  const std::optional<Vec2>& target() const { return target_; }

  // The cell from which a way begins for a person at `from`; nothing if no way is known.
  std::optional<std::size_t> StartOf(const Vec2& from) const {
    if (!target_) return std::nullopt;
    return grid_.Nearest(from, [&](std::size_t cell) { return length_[cell] != kUnreached; });
  }
  // A person can stand at the centre of the cell around `p`, and walk from there to the goal.
  bool Reaches(const Vec2& p) const { return grid_.Contains(p) && ReachesCell(grid_.CellOf(p)); }
  bool ReachesCell(std::size_t cell) const { return target_ && length_[cell] != kUnreached; }
  // m, by steps between cells.
  double LengthFrom(std::size_t cell) const { return length_[cell] * grid_.cell() / WalkGrid::kStraight; }
  bool IsTarget(std::size_t cell) const { return length_[cell] == 0; }
  // The neighbour with the shortest way, of equal ones the first; the cell itself where no way is shorter.
  std::size_t NextCell(std::size_t cell) const;
  // So many steps are a stride: of a long way each person looks up the ends of strides, not all cells.
  int stride() const { return stride_; }
  // The cell of which a whole block of cells, a stride wide, uses the way: the same for all cells of the block but
  // those in a doorway, and for blocks with a wall in that cell. A way from beside is as good, where it is in sight.
  std::size_t SharedStart(std::size_t cell) const;
  // The cell a stride ahead, or the last one of the way.
  std::size_t CellAhead(std::size_t cell) const;

 private:
  static constexpr int kStride = 4;
  static constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();
  class Costs;

  void MeasureLengths(std::size_t target);

  const WalkGrid& grid_;
  std::optional<Vec2> target_;
  std::vector<std::uint32_t> length_;  // by cell, kStraight for the side of one; empty without a target
  int stride_ = kStride;
  // By cell, a number for columns and rows: found when a person first comes by, by any thread, as a pure function of
  // the lengths.
  mutable std::vector<std::atomic<std::uint8_t>> strides_;
};

}  // namespace troupe
