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

// One of those near a point.
struct NearDisc {
  double square = 0.0;  // m^2, of its distance
  std::uint32_t number = 0;
  bool operator<(const NearDisc& o) const { return square != o.square ? square < o.square : number < o.number; }
};

// Adds one to the `most` nearest ones, by distance and number. REQUIRES: those are sorted.
inline void AddNearest(const NearDisc& disc, std::size_t most, std::vector<NearDisc>& nearest) {
  if (nearest.size() == most) {
    if (!(disc < nearest.back())) return;
    nearest.pop_back();
  }
  nearest.insert(std::upper_bound(nearest.begin(), nearest.end(), disc), disc);
}

// The discs by the cells of a grid that their centres are in, row by row of its cells. People on one level do not see
// the others, and most discs are on another level or beyond reach: what tells this of a disc is beside its number.
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
    places_.resize(discs.size());
    for (std::size_t i = 0; i < discs.size(); ++i) {
      const Disc& disc = discs[i];
      places_[first_[grid_.CellOf(disc.center) + 1]++] = {disc.center, disc.radius, disc.z,
                                                          static_cast<std::uint32_t>(i)};
    }
  }

  // Calls visit(number) for all discs at heights `z` that may reach within `reach` of `p`.
  template <typename Visit>
  void ForEachNear(const Vec2& p, const ZRange& z, double reach, Visit visit) const {
    constexpr double kRounding = 1e-6;  // m
    const CellRange range = grid_.CellsOf(Rectangle::Around(p, reach + max_radius_));
    for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
      const std::uint32_t end = first_[grid_.CellAt(range.max_column, row) + 1];
      for (std::uint32_t i = first_[grid_.CellAt(range.min_column, row)]; i < end; ++i) {
        const Place& place = places_[i];
        const double far = reach + place.radius + kRounding;
        if ((place.center - p).squaredNorm() <= far * far && place.z.Overlaps(z)) visit(place.number);
      }
    }
  }

 private:
  struct Place {
    Vec2 center{0.0, 0.0};
    double radius = 0.0;
    ZRange z;
    std::uint32_t number = 0;
  };

  Grid grid_;
  double max_radius_ = 0.0;
  std::vector<std::uint32_t> first_;  // by cell
  std::vector<Place> places_;
};

}  // namespace troupe
