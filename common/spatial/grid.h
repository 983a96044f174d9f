// Grid: how a rectangle of the plane is divided into square cells, numbered row by row. What lies beyond the rectangle
// belongs to the nearest cell at its edge, so that every point has a cell.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/geometry/rectangle.h"
#include "common/geometry/vec2.h"

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

  // Covers `bounds` with cells of `cell_size` metres, or of larger ones if it would take more than `max_cells` otherwise.
  // REQUIRES: bounds finite and not empty; cell_size > 0; max_cells >= 1
  Grid(const Rectangle& bounds, double cell_size, double max_cells);

  const Rectangle& bounds() const { return bounds_; }
  double cell_size() const { return cell_size_; }
  std::size_t cell_count() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }

  std::size_t CellAt(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  std::size_t CellOf(const Vec2& p) const { return CellAt(ColumnOf(p.x()), RowOf(p.y())); }
  CellRange CellsOf(const Rectangle& box) const {
    return {ColumnOf(box.min_x), RowOf(box.min_y), ColumnOf(box.max_x), RowOf(box.max_y)};
  }

  // Calls visit(cell, distance) for the cells that the ray passes, in order, with the distance at which it enters each,
  // until `visit` returns false, `max_distance` is reached or the ray leaves the bounds. REQUIRES: |direction| = 1.
  template <typename Visit>
  void WalkRay(const Vec2& origin, const Vec2& direction, double max_distance, Visit visit) const;

 private:
  static std::int32_t Clamped(double index, std::int32_t count) {
    return index > 0.0 ? static_cast<std::int32_t>(std::min(index, static_cast<double>(count - 1))) : 0;
  }
  std::int32_t ColumnOf(double x) const { return Clamped((x - bounds_.min_x) * cells_per_metre_, columns_); }
  std::int32_t RowOf(double y) const { return Clamped((y - bounds_.min_y) * cells_per_metre_, rows_); }

  Rectangle bounds_;
  double cell_size_ = 1.0;
  double cells_per_metre_ = 1.0;
  std::int32_t columns_ = 1;
  std::int32_t rows_ = 1;
};

template <typename Visit>
void Grid::WalkRay(const Vec2& origin, const Vec2& direction, double max_distance, Visit visit) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // Where the ray enters and leaves the bounds.
  double enter = 0.0;
  double leave = max_distance;
  const double low[2] = {bounds_.min_x, bounds_.min_y};
  const double high[2] = {bounds_.max_x, bounds_.max_y};
  double per_metre[2];
  for (int axis = 0; axis < 2; ++axis) {
    per_metre[axis] = direction[axis] != 0.0 ? 1.0 / direction[axis] : kNever;
    if (direction[axis] == 0.0) {
      if (origin[axis] < low[axis] || origin[axis] > high[axis]) return;
      continue;
    }
    const double a = (low[axis] - origin[axis]) * per_metre[axis];
    const double b = (high[axis] - origin[axis]) * per_metre[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > leave) return;

  const std::int32_t count[2] = {columns_, rows_};
  std::int32_t cell[2] = {ColumnOf(origin.x() + enter * direction.x()), RowOf(origin.y() + enter * direction.y())};
  std::int32_t step[2];
  double next[2];  // distance at which the ray leaves the cell along each axis
  const auto boundary = [&](int axis) {
    if (step[axis] == 0) return kNever;
    const double line = low[axis] + (cell[axis] + (step[axis] > 0 ? 1 : 0)) * cell_size_;
    return (line - origin[axis]) * per_metre[axis];
  };
  for (int axis = 0; axis < 2; ++axis) {
    step[axis] = direction[axis] > 0.0 ? 1 : (direction[axis] < 0.0 ? -1 : 0);
    next[axis] = boundary(axis);
  }
  double distance = enter;
  while (visit(CellAt(cell[0], cell[1]), distance)) {
    const int axis = next[0] <= next[1] ? 0 : 1;
    distance = next[axis];
    if (distance > leave) return;
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= count[axis]) return;
    next[axis] = boundary(axis);
  }
}

}  // namespace troupe
