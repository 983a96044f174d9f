#include "common/spatial/walk_block.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace troupe {

// The variants of WalkBlock::Start.
class WalkStarters {
 public:
  static void OneByOne(const WalkBlock& rays, const Grid& grid, std::span<GridWalk> walks) {
    for (std::size_t i = 0; i < walks.size(); ++i) {
      walks[i] = GridWalk(grid, {rays.x_[i], rays.y_[i]}, {rays.dx_[i], rays.dy_[i]},
                          {rays.inverse_x_[i], rays.inverse_y_[i]}, rays.max_distance_[i]);
    }
  }

#ifdef TROUPE_HAS_AVX512
  [[gnu::target("avx512f,avx512dq")]] static void ByAvx512(const WalkBlock& rays, const Grid& grid,
                                                           std::span<GridWalk> walks) {
    bool start_inside = true;
    for (std::size_t i = 0; i < walks.size(); ++i) start_inside &= grid.bounds().Contains({rays.x_[i], rays.y_[i]});
    if (!start_inside) return OneByOne(rays, grid, walks);
    for (std::size_t first = 0; first < walks.size(); first += kVector) {
      StartInside(rays, first, grid, walks.subspan(first, std::min(kVector, walks.size() - first)));
    }
  }

 private:
  static constexpr std::size_t kVector = 8;
  using Doubles [[gnu::vector_size(kVector * sizeof(double))]] = double;
  using Wholes [[gnu::vector_size(kVector * sizeof(double))]] = std::int64_t;

  [[gnu::always_inline]] static void Load(const WalkBlock::Column& column, std::size_t first, Doubles& numbers) {
    std::memcpy(&numbers, &column[first], sizeof numbers);
  }
  // As Grid::Axis::Clamped.
  [[gnu::always_inline]] static void Clamp(const Doubles& distances, const Doubles& last, Wholes& cells) {
    const Doubles zero{};
    const Doubles bounded = distances < last ? distances : last;
    cells = __builtin_convertvector(bounded > zero ? bounded : zero, Wholes);
  }

  // The constructor of GridWalk for rays `first_ray` and following, which start in the grid: the same operations, with
  // selections in place of branches.
  [[gnu::target("avx512f,avx512dq")]] static void StartInside(const WalkBlock& rays, std::size_t first_ray,
                                                              const Grid& grid, std::span<GridWalk> walks) {
    Doubles x;
    Doubles y;
    Doubles dx;
    Doubles dy;
    Doubles inverse_x;
    Doubles inverse_y;
    Doubles max_distance;
    Load(rays.x_, first_ray, x);
    Load(rays.y_, first_ray, y);
    Load(rays.dx_, first_ray, dx);
    Load(rays.dy_, first_ray, dy);
    Load(rays.inverse_x_, first_ray, inverse_x);
    Load(rays.inverse_y_, first_ray, inverse_y);
    Load(rays.max_distance_, first_ray, max_distance);

    const double per_metre = grid.cells_per_metre();
    const Grid::Axis& axis_x = grid.axis(0);
    const Grid::Axis& axis_y = grid.axis(1);
    const Doubles zero{};
    const Doubles one = zero + 1.0;
    const Wholes is_flat = (dx < 0.0 ? -dx : dx) >= (dy < 0.0 ? -dy : dy);
    const Doubles from_x = (x - axis_x.low) * per_metre;
    const Doubles from_y = (y - axis_y.low) * per_metre;
    const Doubles from_column = is_flat ? from_x : from_y;
    const Doubles from_row = is_flat ? from_y : from_x;
    const Doubles along = is_flat ? dx : dy;
    const Doubles columns_per_metre = along * per_metre;
    const Doubles rows_per_metre = (is_flat ? dy : dx) * per_metre;
    const Doubles inverse = is_flat ? inverse_x : inverse_y;
    const Doubles last_x = zero + static_cast<double>(axis_x.count - 1);
    const Doubles last_y = zero + static_cast<double>(axis_y.count - 1);
    const Doubles last_column = is_flat ? last_x : last_y;
    const Doubles last_row = is_flat ? last_y : last_x;

    const Wholes is_forwards = along > zero;
    const Doubles up = is_forwards ? one : -one;
    Wholes first;
    Wholes last;
    Clamp(from_column, last_column, first);
    Clamp(from_column + max_distance * columns_per_metre, last_column, last);
    const Doubles metres_per_column = grid.cell_size() * (inverse < 0.0 ? -inverse : inverse);
    const Doubles first_left =
        (__builtin_convertvector(first, Doubles) + (0.5 + 0.5 * up) - from_column) * up * metres_per_column;

    constexpr double kCell = static_cast<double>(std::int64_t{1} << GridWalk::kBits);
    const Doubles row_count = last_row + 1.0;
    const Wholes end = __builtin_convertvector(row_count, Wholes) << GridWalk::kBits;
    const Doubles first_row_left = from_row + first_left * rows_per_metre;
    const Doubles below_end = first_row_left < row_count ? first_row_left : row_count;
    Wholes row_left = __builtin_convertvector((below_end > -one ? below_end : -one) * kCell, Wholes);
    const Wholes is_below = (rows_per_metre >= zero) & (row_left < 0);
    row_left = is_below ? Wholes{} : row_left;
    const Wholes is_above = (rows_per_metre <= zero) & (row_left >= end);
    row_left = is_above ? end - 1 : row_left;
    const Wholes first_left_row = row_left >> GridWalk::kBits;
    Wholes first_row;
    Clamp(from_row, last_row, first_row);
    first_row = first_row > first_left_row - 1 ? first_row : first_left_row - 1;
    first_row = first_row < first_left_row + 1 ? first_row : first_left_row + 1;
    const Wholes rise = __builtin_convertvector(rows_per_metre * metres_per_column * kCell, Wholes);
    const Wholes steps = is_forwards ? last - first : first - last;
    const Wholes stride_x = Wholes{} + axis_x.stride;
    const Wholes stride_y = Wholes{} + axis_y.stride;
    const Wholes stride = is_flat ? stride_x : stride_y;
    const Wholes row_stride = is_flat ? stride_y : stride_x;
    const Wholes column_stride = is_forwards ? stride : -stride;
    const Wholes column_offset = first * stride;
    const Wholes row = first_row * row_stride;

    for (std::size_t i = 0; i < walks.size(); ++i) {
      GridWalk& walk = walks[i];
      walk.step_ = 0;
      walk.last_ = steps[i];
      walk.column_offset_ = column_offset[i];
      walk.column_stride_ = column_stride[i];
      walk.row_ = row[i];
      walk.row_stride_ = row_stride[i];
      walk.row_left_ = row_left[i];
      walk.rise_ = rise[i];
      walk.end_ = end[i];
      walk.enter_ = 0.0;
      walk.first_left_ = first_left[i];
      walk.metres_per_column_ = metres_per_column[i];
    }
  }
#endif
};

namespace {

constexpr auto kStarters = std::to_array<Variant<WalkBlock::Starter>>({
    {Instructions::kAny, &WalkStarters::OneByOne},
#ifdef TROUPE_HAS_AVX512
    {Instructions::kAvx512, &WalkStarters::ByAvx512},
#endif
});

WalkBlock::Starter* const kQuickestStarter = RunnableOf(kStarters).back().run;

}  // namespace

std::span<const Variant<WalkBlock::Starter>> WalkBlock::Starters() {
  return RunnableOf(kStarters);
}

void WalkBlock::Start(const Grid& grid, std::span<GridWalk> walks) const {
  kQuickestStarter(*this, grid, walks);
}

}  // namespace troupe
