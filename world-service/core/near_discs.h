// NearDiscs: the discs near a point, for the decisions of people. Private to this folder.
//
// A grid of the centres in fixed cells of 2 m, filled once in a tick and then read by all threads. Each disc is in the
// one cell of its centre, so that none is visited twice; the largest radius is added to the search instead. A search
// goes outwards ring by ring, and can end early when the caller has enough near ones.
//
// The order of visits is that of cells and rings: it depends on the grid alone, but callers that keep the nearest sort
// by (distance, number) (NearDisc), so that the order has no influence. Lengths in m, in frame W.
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
  Vec2 heading{0.0, 0.0};  // of length 1, of a person that walks
  double radius = 0.0;
  ZRange z;
  bool is_robot = false;
  const std::vector<ConvexPiece>* pieces = nullptr;  // in W; null: a person

  // Its sides are walls.
  bool is_object() const { return pieces != nullptr && !is_robot; }
};

// A disc near a point. Ordered by distance, then by number: a total order.
struct NearDisc {
  double square = 0.0;  // m^2, of its distance
  std::uint32_t number = 0;
  bool operator<(const NearDisc& o) const { return square != o.square ? square < o.square : number < o.number; }
};

// Adds a disc to the `most` nearest ones, by distance and number. REQUIRES: `nearest` is sorted.
inline void AddNearest(const NearDisc& disc, std::size_t most, std::vector<NearDisc>& nearest) {
  if (nearest.size() == most) {
    if (!(disc < nearest.back())) return;
    nearest.pop_back();
  }
  nearest.insert(std::upper_bound(nearest.begin(), nearest.end(), disc), disc);
}

// Some of the discs, by the cells of a grid that their centres are in, row by row of its cells. People on one level do
// not see the others, and most discs are on another level or beyond reach: what tells this of a disc is beside its
// number.
class NearDiscs {
 public:
  // Replaces the contents by the discs that accept(disc) is true for. Linear in the number of discs.
  template <typename Accept>
  void Fill(const std::vector<Disc>& discs, Accept accept) {
    Rectangle bounds = Rectangle::Nothing();
    max_radius_ = 0.0;
    for (const Disc& disc : discs) {
      bounds.Extend(disc.center);
      if (accept(disc)) max_radius_ = std::max(max_radius_, disc.radius);
    }
    constexpr double kCell = 2.0;  // m
    grid_ = Grid(bounds.Inflated(kCell), kCell, 4.0 * static_cast<double>(discs.size()) + 64.0);
    // A counting sort by cell, which keeps the order of the discs within a cell.
    first_.assign(grid_.cell_count() + 2, 0);
    for (const Disc& disc : discs) first_[grid_.CellOf(disc.center) + 2] += accept(disc) ? 1 : 0;
    for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
    places_.resize(first_.back());
    for (std::size_t i = 0; i < discs.size(); ++i) {
      const Disc& disc = discs[i];
      if (!accept(disc)) continue;
      places_[first_[grid_.CellOf(disc.center) + 1]++] = {disc.center, disc.radius, disc.z,
                                                          static_cast<std::uint32_t>(i)};
    }
  }

  // Calls visit(number) for all discs at heights `z` that may reach within `reach` of `p`, from one ring of cells
  // around `p` to the next, until done(distance): discs with centres farther away do not matter. REQUIRES: `p` is
  // the centre of one of the discs of Fill.
  template <typename Visit, typename Done>
  void ForEachNear(const Vec2& p, const ZRange& z, double reach, Visit visit, Done done) const {
    const CellRange all = grid_.CellsOf(Rectangle::Around(p, reach + max_radius_));
    const CellRange own = grid_.CellsOf(Rectangle::Around(p, 0.0));
    const auto scan = [&](std::int32_t row, std::int32_t from, std::int32_t to) {
      from = std::max(from, all.min_column);
      to = std::min(to, all.max_column);
      if (from > to) return;
      // Callers compare exactly; here a disc too many does no harm, and one too few would.
      constexpr double kRounding = 1e-6;  // m
      const std::uint32_t end = first_[grid_.CellAt(to, row) + 1];
      for (std::uint32_t i = first_[grid_.CellAt(from, row)]; i < end; ++i) {
        const Place& place = places_[i];
        const double far = reach + place.radius + kRounding;
        if ((place.center - p).squaredNorm() <= far * far && place.z.Overlaps(z)) visit(place.number);
      }
    };
    for (std::int32_t ring = 0;; ++ring) {
      const CellRange block{own.min_column - ring, own.min_row - ring, own.min_column + ring, own.min_row + ring};
      for (std::int32_t row = std::max(block.min_row, all.min_row); row <= std::min(block.max_row, all.max_row);
           ++row) {
        if (row == block.min_row || row == block.max_row) {
          scan(row, block.min_column, block.max_column);
        } else {
          scan(row, block.min_column, block.min_column);
          scan(row, block.max_column, block.max_column);
        }
      }
      const bool is_last = block.min_column <= all.min_column && block.max_column >= all.max_column &&
                           block.min_row <= all.min_row && block.max_row >= all.max_row;
      if (is_last || done(ring * grid_.cell_size())) return;
    }
  }
  template <typename Visit>
  void ForEachNear(const Vec2& p, const ZRange& z, double reach, Visit visit) const {
    ForEachNear(p, z, reach, visit, [](double) { return false; });
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
