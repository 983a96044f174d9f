// NearDiscs: the discs near a point. Private to this folder.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/grid.h"
#include "troupe/z_range.h"

namespace troupe {

// A person, or a robot or an object, as people see it.
struct Disc {
  Vec2 center{0.0, 0.0};  // m
  Vec2 velocity{0.0, 0.0};
  double radius = 0.0;
  ZRange z;
  bool is_robot = false;
  const std::vector<ConvexPiece>* pieces = nullptr;  // in W; null: a person
};

// The numbers of discs by the cells of a grid that their centres are in.
class NearDiscs {
 public:
  void Fill(const std::vector<Disc>& discs) {
    Rectangle bounds = Rectangle::Nothing();
    max_radius_ = 0.0;
    for (const Disc& disc : discs) {
      bounds.Extend(disc.center);
      max_radius_ = std::max(max_radius_, disc.radius);
    }
    constexpr double kCell = 2.0;  // m
    grid_ = Grid(bounds.Inflated(kCell), kCell, 4.0 * static_cast<double>(discs.size()) + 64.0);
    first_.assign(grid_.cell_count() + 2, 0);
    for (const Disc& disc : discs) ++first_[grid_.CellOf(disc.center) + 2];
    for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
    numbers_.resize(discs.size());
    for (std::size_t i = 0; i < discs.size(); ++i) {
      numbers_[first_[grid_.CellOf(discs[i].center) + 1]++] = static_cast<std::uint32_t>(i);
    }
  }

  // Calls visit(number) for all discs that may reach within `reach` of `p`.
  template <typename Visit>
  void ForEachNear(const Vec2& p, double reach, Visit visit) const {
    const CellRange range = grid_.CellsOf(Rectangle::Around(p, reach + max_radius_));
    for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
      for (std::int32_t column = range.min_column; column <= range.max_column; ++column) {
        const std::size_t cell = grid_.CellAt(column, row);
        for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) visit(numbers_[i]);
      }
    }
  }

 private:
  Grid grid_;
  double max_radius_ = 0.0;
  std::vector<std::uint32_t> first_;  // by cell
  std::vector<std::uint32_t> numbers_;
};

}  // namespace troupe
