// Grid: a rectangle of the plane divided into square cells, numbered row by row. Points beyond the rectangle belong to
// the nearest cell at its edge, so that every point has a cell.
//
// A grid knows no contents: the index that uses it has lists by the number of a cell. Conversions clamp, so that a
// point far away, an infinite one and NaN have a cell, too, and no index of a list can be out of its range. Frame and
// unit are those of the bounds; all users here are in W or in the frame of a bitmap, in m.
#pragma once

#include <algorithm>
#include <array>
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

}  // namespace troupe
