// StaticIndex: the pieces of all models that never move, in a uniform grid.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "common/geometry/rectangle.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/grid.h"
#include "common/spatial/ray_walk.h"

namespace troupe {

class StaticIndex {
 public:
  StaticIndex() = default;
  explicit StaticIndex(std::vector<ConvexPiece> pieces);

  const std::vector<ConvexPiece>& pieces() const { return pieces_; }
  const Rectangle& bounds() const { return bounds_; }

  // Indices of the pieces whose bounding boxes overlap `box` (touching counts): ascending, without repeats. Appends to
  // `result`.
  void Query(const Rectangle& box, std::pmr::vector<std::uint32_t>& result) const;

  // The data of a piece that rays need, small and close to its neighbours in memory: one line of a cache.
  struct alignas(64) RayPiece {
    Rectangle box;  // m, around the piece
    ZRange z;       // m; empty if rays look through the piece
    ModelId model;
    bool is_box = false;  // the piece fills the box
    std::uint32_t first_vertex = 0;
    std::uint32_t vertex_count = 0;
  };
  const RayPiece& ray_piece(std::uint32_t index) const { return ray_pieces_[index]; }
  std::span<const Vec2> vertices(const RayPiece& piece) const {
    return {vertices_.data() + piece.first_vertex, piece.vertex_count};
  }

  // Calls visit(indices of pieces, distance) for the parts of the index that the ray passes and that have any, in
  // order, with a distance before which it does not enter each part, until `visit` returns false. Every piece that the
  // ray hits within `max_distance` is among those visited at a distance not beyond the hit; pieces may occur several
  // times. REQUIRES: |direction| = 1; inverse = 1 / direction by components
  template <typename Visit>
  void WalkRay(const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse, double max_distance,
               Visit visit) const {
    if (pieces_.empty()) return;
    troupe::WalkRay(
        grid_, origin, direction, inverse, max_distance, [this](std::size_t cell) { return filled_[cell]; },
        [&](std::size_t cell, double distance) { return visit(PiecesInCell(cell), distance); });
  }

 private:
  std::span<const std::uint32_t> PiecesInCell(std::size_t cell) const {
    return {cell_pieces_.data() + cell_start_[cell], cell_pieces_.data() + cell_start_[cell + 1]};
  }
  // The cells whose neighbourhood the piece touches, because the walk of a ray along an edge may be in either cell.
  CellRange CellsOf(const ConvexPiece& piece) const;

  void FillCells();

  std::vector<ConvexPiece> pieces_;
  std::vector<RayPiece> ray_pieces_;  // by the same indices
  std::vector<Vec2> vertices_;
  Rectangle bounds_ = Rectangle::Nothing();
  Grid grid_;
  // The pieces of cell c are cell_pieces_[cell_start_[c]] up to cell_pieces_[cell_start_[c + 1]], ascending.
  std::vector<std::uint32_t> cell_start_;
  // 1 for each cell with pieces: rays mostly pass empty cells, and then read nothing else.
  std::vector<std::uint8_t> filled_;
  std::vector<std::uint32_t> cell_pieces_;
};

}  // namespace troupe
