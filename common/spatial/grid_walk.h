// GridWalk, WalkRay: the cells of a grid that a ray passes.
//
// A ray gains at most one row in each column that it crosses if it is flat, and the other way round if it is steep. So
// it is followed column by column, and the row in which it leaves a column is one addition of whole numbers away from
// that of the column before. No branch depends on the side by which it leaves a cell, which no processor can predict
// (as in Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", 1987).
//
// The walk is conservative: it may visit a cell that the ray just misses, and its users test the pieces of a cell
// exactly. It misses none that the ray passes by more than kWalkTolerance of a cell, for which indices enter a piece
// into the cells of its neighbourhood, too.
//
// The same arithmetic runs for one ray or for eight in a vector (walk_block.h), so that both give the same cells.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "common/spatial/grid.h"
#include "troupe/rectangle.h"
#include "troupe/vec2.h"

namespace troupe {

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

// From numbers to whole numbers or back, or vectors of them; a fraction is cut off.
template <typename From, typename To>
[[gnu::always_inline]] inline void Convert(const From& from, To& to) {
  if constexpr (std::is_arithmetic_v<From>) {
    to = static_cast<To>(from);
  } else {
    to = __builtin_convertvector(from, To);
  }
}

// The walk of one ray, or as vectors the walks of several. From their start on lengths are in cells; columns lie along
// the axis on which the ray passes more cells, rows along the other axis.
template <typename Number, typename Whole>
struct WalkState {
  // Rows are whole numbers, a cell being 1 << kBits: their errors do not grow with the distance from 0.
  static constexpr int kBits = 40;

  Whole last{};  // step; the first is 0
  Whole column_offset{};
  Whole column_stride{};
  Whole row{};  // offset of the row in which the ray enters the next column
  Whole row_stride{};
  Whole row_left{};     // where it leaves that column
  Whole rise{};         // of a column
  Whole end{};          // of the rows
  Number first_left{};  // m, where the ray leaves the first column
  Number metres_per_column{};
};

// What the walks start from.
template <typename Number, typename Whole>
struct WalkRays {
  Number from_column;  // cells, of the origin from the first column
  Number from_row;
  Number columns_per_metre;  // along the ray
  Number rows_per_metre;
  Number metres_per_column;  // > 0
  Number last_column;        // of the grid
  Number last_row;
  Whole column_stride;
  Whole row_stride;
  Number enter;  // m along the ray, where it is in the grid first
  Number leave;  // and last
};

// The cell nearest to a distance in cells, of an axis whose last cell is `last`. As Grid::Axis::Clamped.
template <typename Number, typename Whole>
[[gnu::always_inline]] inline void ToCell(const Number& distance, const Number& last, Whole& cell) {
  const Number zero{};
  const Number bounded = distance < last ? distance : last;
  Convert(bounded > zero ? bounded : zero, cell);
}

// Selections stand where a function of one ray would branch. None selects whole numbers by a comparison of numbers,
// which gcc 12 does lane by lane.
template <typename Number, typename Whole>
[[gnu::always_inline]] inline void StartWalks(const WalkRays<Number, Whole>& rays, WalkState<Number, Whole>& state) {
  const Number zero{};
  const Number one = zero + 1.0;
  const Number up = rays.columns_per_metre > zero ? one : -one;
  Whole step;
  Convert(up, step);
  Whole first;
  Whole last;
  ToCell(rays.from_column + rays.enter * rays.columns_per_metre, rays.last_column, first);
  ToCell(rays.from_column + rays.leave * rays.columns_per_metre, rays.last_column, last);
  state.last = (last - first) * step;
  state.column_offset = first * rays.column_stride;
  state.column_stride = rays.column_stride * step;
  Number first_column;
  Convert(first, first_column);
  state.first_left = (first_column + (0.5 + 0.5 * up) - rays.from_column) * up * rays.metres_per_column;
  state.metres_per_column = rays.metres_per_column;

  constexpr int kBits = WalkState<Number, Whole>::kBits;
  constexpr double kCell = static_cast<double>(std::int64_t{1} << kBits);
  const Number row_count = rays.last_row + 1.0;
  Whole rows;
  Convert(row_count, rows);
  state.end = rows << kBits;
  const Number first_row_left = rays.from_row + state.first_left * rays.rows_per_metre;
  const Number below_end = first_row_left < row_count ? first_row_left : row_count;
  // If a ray enters at a corner, rounding may place its exit from the first column on the wrong side of the edge; and
  // if it passes from corner to corner, the rows in which it enters and leaves may be two apart.
  const Number lowest = rays.rows_per_metre >= zero ? zero : -one;
  Whole row_left;
  Convert((below_end > lowest ? below_end : lowest) * kCell, row_left);
  Whole is_down;
  Convert(rays.rows_per_metre <= zero ? one : zero, is_down);
  const Whole highest = state.end - is_down;
  row_left = row_left < highest ? row_left : highest;
  state.row_left = row_left;
  const Whole first_left_row = row_left >> kBits;
  Whole row;
  ToCell(rays.from_row + rays.enter * rays.rows_per_metre, rays.last_row, row);
  row = row > first_left_row - 1 ? row : first_left_row - 1;
  row = row < first_left_row + 1 ? row : first_left_row + 1;
  state.row = row * rays.row_stride;
  state.row_stride = rays.row_stride;
  Convert(rays.rows_per_metre * rays.metres_per_column * kCell, state.rise);
}

class GridWalk {
 public:
  using State = WalkState<double, std::int64_t>;

  GridWalk() = default;
  // REQUIRES: |direction| = 1; inverse = 1 / direction by components
  GridWalk(const Grid& grid, const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse,
           double max_distance) {
    RayPart part{0.0, max_distance};
    // A walk that starts inside ends at the edge without a cut.
    if (!grid.bounds().Contains(origin)) part = PartWithin(grid.bounds(), origin, direction, inverse, max_distance);
    if (!(part.enter <= part.leave)) return;
    const int major = std::abs(direction.x()) >= std::abs(direction.y()) ? 0 : 1;
    const Grid::Axis& columns = grid.axis(major);
    const Grid::Axis& rows = grid.axis(1 - major);
    const WalkRays<double, std::int64_t> ray{.from_column = (origin[major] - columns.low) * grid.cells_per_metre(),
                                             .from_row = (origin[1 - major] - rows.low) * grid.cells_per_metre(),
                                             .columns_per_metre = direction[major] * grid.cells_per_metre(),
                                             .rows_per_metre = direction[1 - major] * grid.cells_per_metre(),
                                             .metres_per_column = grid.cell_size() * std::abs(inverse[major]),
                                             .last_column = static_cast<double>(columns.count - 1),
                                             .last_row = static_cast<double>(rows.count - 1),
                                             .column_stride = columns.stride,
                                             .row_stride = rows.stride,
                                             .enter = part.enter,
                                             .leave = part.leave};
    StartWalks(ray, state_);
    enter_ = part.enter;
  }

  // Becomes the walk `lane` of several that start in the grid. Writes member by member: a copy of a state would wait
  // for the writes of its parts.
  template <typename Number, typename Whole>
  void Begin(const WalkState<Number, Whole>& starts, std::size_t lane) {
    step_ = 0;
    enter_ = 0.0;
    state_.last = starts.last[lane];
    state_.column_offset = starts.column_offset[lane];
    state_.column_stride = starts.column_stride[lane];
    state_.row = starts.row[lane];
    state_.row_stride = starts.row_stride[lane];
    state_.row_left = starts.row_left[lane];
    state_.rise = starts.rise[lane];
    state_.end = starts.end[lane];
    state_.first_left = starts.first_left[lane];
    state_.metres_per_column = starts.metres_per_column[lane];
  }

  // Goes to the next column in which a cell that the ray passes is filled; false if there is none. A function of its
  // own: its loop over empty columns, where most of the time of a walk goes, needs all registers.
  template <typename Filled>
  [[gnu::noinline]] bool Next(Filled filled) {
    std::int64_t offset = state_.column_offset;
    std::int64_t row = state_.row;
    std::int64_t row_left = state_.row_left;
    for (std::int64_t step = step_; step <= state_.last;
         ++step, offset += state_.column_stride, row_left += state_.rise) {
      std::int64_t next_row = row;
      if (static_cast<std::uint64_t>(row_left) < static_cast<std::uint64_t>(state_.end)) {
        next_row = (row_left >> State::kBits) * state_.row_stride;
      } else {
        state_.last = step;
      }
      const auto cell = static_cast<std::size_t>(offset + row);
      const auto next = static_cast<std::size_t>(offset + next_row);
      if (static_cast<int>(filled(cell)) | static_cast<int>(filled(next))) {  // one branch, not two
        cells_ = {cell, next};
        step_ = step + 1;
        state_.column_offset = offset + state_.column_stride;
        state_.row = next_row;
        state_.row_left = row_left + state_.rise;
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
    return step_ == 1 ? enter_ : state_.first_left + static_cast<double>(step_ - 2) * state_.metres_per_column;
  }

 private:
  State state_{.last = -1};  // of the next column
  std::int64_t step_ = 0;    // that column; the first is 0
  std::array<std::size_t, 2> cells_{};
  double enter_ = 0.0;  // m
};

// Calls visit(cell, distance) for the cells on the ray's way for which filled(cell) is true, in order, until
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
