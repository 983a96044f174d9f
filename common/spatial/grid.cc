#include "common/spatial/grid.h"

#include "troupe/check.h"

namespace troupe {
namespace {

// Keeps the rounding of a ray's walk, which adds up cell by cell, far within its tolerance (grid.h).
constexpr double kMaxCellsAlong = 65536.0;

}  // namespace

Grid::Grid(const Rectangle& bounds, double cell_size, double max_cells) : bounds_(bounds), cell_size_(cell_size) {
  TROUPE_CHECK(!bounds.empty() && cell_size > 0.0 && max_cells >= 1.0);
  const auto cells_along = [this](double length) { return std::max(1.0, std::ceil(length / cell_size_)); };
  const auto too_many = [&](double columns, double rows) {
    return columns * rows > max_cells || std::max(columns, rows) > kMaxCellsAlong;
  };
  // By steps of a quarter: a grid of any world is made, with larger cells, whatever its extent.
  while (too_many(cells_along(bounds.width()), cells_along(bounds.height()))) cell_size_ *= 1.25;
  cells_per_metre_ = 1.0 / cell_size_;
  const auto columns = static_cast<std::int32_t>(cells_along(bounds.width()));
  const auto rows = static_cast<std::int32_t>(cells_along(bounds.height()));
  axes_ = {Axis{bounds.min_x, columns, 1}, Axis{bounds.min_y, rows, columns}};
}

}  // namespace troupe
