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
    if (walks.size() == 1) return OneByOne(rays, grid, walks);  // a vector for one ray takes longer
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

  // For rays `first` and following.
  [[gnu::target("avx512f,avx512dq")]] static void StartInside(const WalkBlock& rays, std::size_t first,
                                                              const Grid& grid, std::span<GridWalk> walks) {
    Doubles x;
    Doubles y;
    Doubles dx;
    Doubles dy;
    Doubles inverse_x;
    Doubles inverse_y;
    WalkRays<Doubles, Wholes> starts;
    Load(rays.x_, first, x);
    Load(rays.y_, first, y);
    Load(rays.dx_, first, dx);
    Load(rays.dy_, first, dy);
    Load(rays.inverse_x_, first, inverse_x);
    Load(rays.inverse_y_, first, inverse_y);
    Load(rays.max_distance_, first, starts.leave);
    starts.enter = Doubles{};

    const Grid::Axis& axis_x = grid.axis(0);
    const Grid::Axis& axis_y = grid.axis(1);
    const Wholes is_flat = (dx < 0.0 ? -dx : dx) >= (dy < 0.0 ? -dy : dy);
    const Doubles from_x = (x - axis_x.low) * grid.cells_per_metre();
    const Doubles from_y = (y - axis_y.low) * grid.cells_per_metre();
    starts.from_column = is_flat ? from_x : from_y;
    starts.from_row = is_flat ? from_y : from_x;
    starts.columns_per_metre = (is_flat ? dx : dy) * grid.cells_per_metre();
    starts.rows_per_metre = (is_flat ? dy : dx) * grid.cells_per_metre();
    const Doubles inverse = is_flat ? inverse_x : inverse_y;
    starts.metres_per_column = grid.cell_size() * (inverse < 0.0 ? -inverse : inverse);
    const Doubles last_x = Doubles{} + static_cast<double>(axis_x.count - 1);
    const Doubles last_y = Doubles{} + static_cast<double>(axis_y.count - 1);
    starts.last_column = is_flat ? last_x : last_y;
    starts.last_row = is_flat ? last_y : last_x;
    const Wholes stride_x = Wholes{} + axis_x.stride;
    const Wholes stride_y = Wholes{} + axis_y.stride;
    starts.column_stride = is_flat ? stride_x : stride_y;
    starts.row_stride = is_flat ? stride_y : stride_x;

    WalkState<Doubles, Wholes> states;
    StartWalks(starts, states);
    for (std::size_t i = 0; i < walks.size(); ++i) walks[i].Begin(states, i);
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
