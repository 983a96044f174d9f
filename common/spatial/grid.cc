#include "common/spatial/grid.h"

#include "common/base/check.h"

namespace troupe {

Grid::Grid(const Rectangle& bounds, double cell_size, double max_cells) : bounds_(bounds), cell_size_(cell_size) {
  TROUPE_CHECK(!bounds.empty() && cell_size > 0.0 && max_cells >= 1.0);
  const auto cells_along = [this](double length) { return std::max(1.0, std::ceil(length / cell_size_)); };
  while (cells_along(bounds.width()) * cells_along(bounds.height()) > max_cells) cell_size_ *= 1.25;
  cells_per_metre_ = 1.0 / cell_size_;
  columns_ = static_cast<std::int32_t>(cells_along(bounds.width()));
  rows_ = static_cast<std::int32_t>(cells_along(bounds.height()));
}

}  // namespace troupe
