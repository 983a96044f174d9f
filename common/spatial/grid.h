// Grid: a rectangle of the plane divided into square cells, numbered row by row. Points beyond the rectangle belong to
// the nearest cell at its edge, so that every point has a cell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "troupe/rectangle.h"
#include "troupe/vec2.h"

namespace troupe {

// A block of cells: columns [min_column, max_column], rows [min_row, max_row].
struct CellRange {
  std::int32_t min_column = 0;
  std::int32_t min_row = 0;
  std::int32_t max_column = 0;
  std::int32_t max_row = 0;

  std::size_t count() const {
    return static_cast<std::size_t>(max_column - min_column + 1) * static_cast<std::size_t>(max_row - min_row + 1);
  }
};

class Grid {
 public:
  Grid() = default;

  // Covers `bounds` with cells of `cell_size` metres, or of larger ones if it would have more than `max_cells`,
  // or more than 65,536 along x or y, otherwise. REQUIRES: bounds finite and not empty; cell_size > 0; max_cells >= 1
  Grid(const Rectangle& bounds, double cell_size, double max_cells);

  const Rectangle& bounds() const { return bounds_; }
  double cell_size() const { return cell_size_; }
  double cells_per_metre() const { return cells_per_metre_; }
  std::size_t cell_count() const {
    return static_cast<std::size_t>(axes_[0].count) * static_cast<std::size_t>(axes_[1].count);
  }

  std::size_t CellAt(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(axes_[0].count) + static_cast<std::size_t>(column);
  }
  std::size_t CellOf(const Vec2& p) const { return CellAt(ColumnOf(p.x()), RowOf(p.y())); }
  CellRange CellsOf(const Rectangle& box) const {
    return {ColumnOf(box.min_x), RowOf(box.min_y), ColumnOf(box.max_x), RowOf(box.max_y)};
  }

  // One coordinate of the cells.
  struct Axis {
    double low = 0.0;  // m, the start of the first cell
    std::int32_t count = 1;
    std::int32_t stride = 1;  // added to a cell's number by a step

    // The number of the cell nearest to this distance from `low`, in cells.
    std::int32_t Clamped(double distance) const {
      return distance > 0.0 ? static_cast<std::int32_t>(std::min(distance, static_cast<double>(count - 1))) : 0;
    }
  };
  const Axis& axis(int i) const { return axes_[i]; }  // x: 0, y: 1

 private:
  std::int32_t ColumnOf(double x) const { return axes_[0].Clamped((x - axes_[0].low) * cells_per_metre_); }
  std::int32_t RowOf(double y) const { return axes_[1].Clamped((y - axes_[1].low) * cells_per_metre_); }

  Rectangle bounds_;
  double cell_size_ = 1.0;
  double cells_per_metre_ = 1.0;
  std::array<Axis, 2> axes_;
};

// WalkRay: the cells of a grid that a ray passes.
//
// A ray gains at most one row in each column that it crosses if it is flat, and the other way round if it is steep. So
// it is followed column by column, and the row in which it leaves a column is one addition of whole numbers away from
// that of the column before. No branch depends on the side by which it leaves a cell, which no processor can predict
// (as in Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", 1987).

// The error of a walk, in cells: the ray is at most so far from the cells visited for it.
inline constexpr double kWalkTolerance = 1e-6;

// The part of a ray, in m along it, within a rectangle; none if `enter` is not at most `leave`.
struct RayPart {
  double enter;
  double leave;
};

inline RayPart PartWithin(const Rectangle& bounds, const Vec2& origin, const Vec2& direction,
                          const Eigen::Array2d& inverse, double max_distance) {
  RayPart part{0.0, max_distance};
  const auto cut = [&part](double from, double along, double inverse_along, double low, double high) {
    if (along == 0.0) {
      if (from < low || from > high) part.leave = -1.0;
      return;
    }
    const double a = (low - from) * inverse_along;
    const double b = (high - from) * inverse_along;
    part.enter = std::max(part.enter, std::min(a, b));
    part.leave = std::min(part.leave, std::max(a, b));
  };
  cut(origin.x(), direction.x(), inverse.x(), bounds.min_x, bounds.max_x);
  cut(origin.y(), direction.y(), inverse.y(), bounds.min_y, bounds.max_y);
  return part;
}

// The walk of one ray. From its start on lengths are in cells, columns are those of the axis along which the ray passes
// more cells, rows those of the other.
class GridWalk {
 public:
  GridWalk() = default;
  // REQUIRES: |direction| = 1; inverse = 1 / direction by components
  GridWalk(const Grid& grid, const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse,
           double max_distance) {
    RayPart part{0.0, max_distance};
    // A walk that starts inside ends at the edge without a cut.
    if (!grid.bounds().Contains(origin)) part = PartWithin(grid.bounds(), origin, direction, inverse, max_distance);
    const auto [enter, leave] = part;
    if (!(enter <= leave)) return;

    const int major = std::abs(direction.x()) >= std::abs(direction.y()) ? 0 : 1;
    const Grid::Axis& columns = grid.axis(major);
    const Grid::Axis& rows = grid.axis(1 - major);
    const double from_column = (origin[major] - columns.low) * grid.cells_per_metre();
    const double from_row = (origin[1 - major] - rows.low) * grid.cells_per_metre();
    const double columns_per_metre = direction[major] * grid.cells_per_metre();
    const double rows_per_metre = direction[1 - major] * grid.cells_per_metre();
    const std::int32_t up = direction[major] > 0.0 ? 1 : -1;
    const std::int32_t first = columns.Clamped(from_column + enter * columns_per_metre);
    const std::int32_t last = columns.Clamped(from_column + leave * columns_per_metre);
    enter_ = enter;
    metres_per_column_ = grid.cell_size() * std::abs(inverse[major]);
    first_left_ = (first + (0.5 + 0.5 * up) - from_column) * up * metres_per_column_;

    constexpr double kCell = static_cast<double>(std::int64_t{1} << kBits);
    const double row_count = rows.count;
    end_ = static_cast<std::int64_t>(rows.count) << kBits;
    const double first_row_left = from_row + first_left_ * rows_per_metre;
    row_left_ = static_cast<std::int64_t>(std::max(-1.0, std::min(row_count, first_row_left)) * kCell);
    // If a ray enters at a corner, rounding may place its exit from the first column on the wrong side of the edge; and
    // if it passes from corner to corner, the rows in which it enters and leaves may be two apart.
    if (rows_per_metre >= 0.0) row_left_ = std::max<std::int64_t>(row_left_, 0);
    if (rows_per_metre <= 0.0) row_left_ = std::min(row_left_, end_ - 1);
    const auto first_left_row = static_cast<std::int32_t>(row_left_ >> kBits);
    const std::int32_t first_row =
        std::clamp(rows.Clamped(from_row + enter * rows_per_metre), first_left_row - 1, first_left_row + 1);
    rise_ = static_cast<std::int64_t>(rows_per_metre * metres_per_column_ * kCell);
    last_ = std::int64_t{last - first} * up;
    column_stride_ = std::ptrdiff_t{up} * columns.stride;
    row_stride_ = rows.stride;
    column_offset_ = std::ptrdiff_t{first} * columns.stride;
    row_ = std::ptrdiff_t{first_row} * rows.stride;
  }

  // Goes to the next column in which a cell that the ray passes is filled; false if there is none. A function of its
  // own: its loop over empty columns, where most of the time of a walk goes, needs all registers.
  template <typename Filled>
  [[gnu::noinline]] bool Next(Filled filled) {
    std::ptrdiff_t offset = column_offset_;
    std::ptrdiff_t row = row_;
    std::int64_t row_left = row_left_;
    for (std::int64_t step = step_; step <= last_; ++step, offset += column_stride_, row_left += rise_) {
      std::ptrdiff_t next_row = row;
      if (static_cast<std::uint64_t>(row_left) < static_cast<std::uint64_t>(end_)) {
        next_row = (row_left >> kBits) * row_stride_;
      } else {
        last_ = step;
      }
      const auto cell = static_cast<std::size_t>(offset + row);
      const auto next = static_cast<std::size_t>(offset + next_row);
      if (static_cast<int>(filled(cell)) | static_cast<int>(filled(next))) {  // one branch, not two
        cells_ = {cell, next};
        step_ = step + 1;
        column_offset_ = offset + column_stride_;
        row_ = next_row;
        row_left_ = row_left + rise_;
        return true;
      }
      row = next_row;
    }
    return false;
  }

  // The cells of this column in which the ray enters and leaves it; both or one of them are filled.
  const std::array<std::size_t, 2>& cells() const { return cells_; }
  // m; the ray does not enter these cells before.
  double entered() const {
    return step_ == 1 ? enter_ : first_left_ + static_cast<double>(step_ - 2) * metres_per_column_;
  }

 private:
  friend class WalkStarters;

  // Rows are whole numbers, a cell being 1 << kBits: their errors do not grow with the distance from 0.
  static constexpr int kBits = 40;

  std::int64_t step_ = 0;   // of the next column; the first is 0
  std::int64_t last_ = -1;  // step
  std::ptrdiff_t column_offset_ = 0;
  std::ptrdiff_t column_stride_ = 0;
  std::ptrdiff_t row_ = 0;  // offset of the row in which the ray enters the next column
  std::ptrdiff_t row_stride_ = 0;
  std::int64_t row_left_ = 0;  // where it leaves that column
  std::int64_t rise_ = 0;      // of a column
  std::int64_t end_ = 0;       // of the rows
  std::array<std::size_t, 2> cells_{};
  double enter_ = 0.0;  // m
  double first_left_ = 0.0;
  double metres_per_column_ = 0.0;
};

// Calls visit(cell, distance) for those cells that the ray passes for which filled(cell) is true, in order, until
// `visit` returns false, `max_distance` is reached or the ray leaves the grid; `distance`: m, the ray does not enter
// the cell before. A few cells that the ray just misses, or that are just beyond its end, may be among them. REQUIRES:
// |direction| = 1; inverse = 1 / direction by components
template <typename Filled, typename Visit>
void WalkRay(const Grid& grid, const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse,
             double max_distance, Filled filled, Visit visit) {
  GridWalk walk(grid, origin, direction, inverse, max_distance);
  while (walk.Next(filled)) {
    const auto [cell, next] = walk.cells();
    const double entered = walk.entered();
    if (filled(cell) && !visit(cell, entered)) return;
    if (cell != next && filled(next) && !visit(next, entered)) return;
  }
}

}  // namespace troupe
