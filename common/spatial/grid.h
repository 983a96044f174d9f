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

  // Covers `bounds` with cells of `cell_size` metres, or of larger ones if it would take more than `max_cells`
  // otherwise. REQUIRES: bounds finite and not empty; cell_size > 0; max_cells >= 1
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
  // until `visit` returns false, `max_distance` is reached or the ray leaves the bounds. REQUIRES: |direction| = 1;
  // inverse = 1 / direction by components.
  template <typename Visit>
  void WalkRay(const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse, double max_distance,
               Visit visit) const;

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

// One coordinate of a ray on its way through the cells.
struct RayAxis {
  double next;          // distance at which the ray leaves its cell along this axis
  double width;         // distance that it takes to cross a cell
  std::ptrdiff_t step;  // what a step adds to the cell's number
  std::int32_t left;    // how many steps there are to the edge

  // For a ray from `origin` that enters the grid in cell number `first` of `count` along this axis, which begins at
  // `low`.
  RayAxis(double origin, double direction, double inverse, double low, double cell_size, std::int32_t first,
          std::int32_t count, std::ptrdiff_t stride) {
    const bool up = direction > 0.0;
    const double line = low + (first + (up ? 1 : 0)) * cell_size;
    next = direction != 0.0 ? (line - origin) * inverse : std::numeric_limits<double>::infinity();
    width = direction != 0.0 ? cell_size * std::abs(inverse) : 0.0;
    step = up ? stride : -stride;
    left = up ? count - 1 - first : first;
  }
};

template <typename Visit>
void Grid::WalkRay(const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse, double max_distance,
                   Visit visit) const {
  // Where the ray enters and leaves the bounds.
  double enter = 0.0;
  double leave = max_distance;
  if (!bounds_.Contains(origin) || !bounds_.Contains(origin + max_distance * direction)) {
    const auto cut = [&](double from, double along, double inverse_along, double low, double high) {
      if (along == 0.0) {
        if (from < low || from > high) leave = -1.0;
        return;
      }
      const double a = (low - from) * inverse_along;
      const double b = (high - from) * inverse_along;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    };
    cut(origin.x(), direction.x(), inverse.x(), bounds_.min_x, bounds_.max_x);
    cut(origin.y(), direction.y(), inverse.y(), bounds_.min_y, bounds_.max_y);
    if (enter > leave) return;
  }

  const std::int32_t column = ColumnOf(origin.x() + enter * direction.x());
  const std::int32_t row = RowOf(origin.y() + enter * direction.y());
  RayAxis x(origin.x(), direction.x(), inverse.x(), bounds_.min_x, cell_size_, column, columns_, 1);
  RayAxis y(origin.y(), direction.y(), inverse.y(), bounds_.min_y, cell_size_, row, rows_, columns_);
  std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(CellAt(column, row));
  double distance = enter;
  // Which axis comes next cannot be foreseen, so both are moved on, one of them by nothing: a jump would cost more.
  while (visit(static_cast<std::size_t>(cell), distance)) {
    const bool along_x = x.next <= y.next;
    distance = along_x ? x.next : y.next;
    x.next += along_x ? x.width : 0.0;
    y.next += along_x ? 0.0 : y.width;
    cell += along_x ? x.step : y.step;
    const std::int32_t left = along_x ? x.left-- : y.left--;
    if (distance > leave || left <= 0) return;
  }
}

}  // namespace troupe
