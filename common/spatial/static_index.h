// StaticIndex: the pieces of all models that never move, in W. Most are kept, in a uniform grid; those of dense bitmaps
// are made when a query asks for them (PixelPieces), because as a list they would take gigabytes.
//
// Invariants: pieces are numbered in the order of their models, and queries return them in that order without repeats,
// so that results do not depend on cells; pieces of areas have the same bits as if they had been listed. The grid is
// chosen so that a piece is in few cells and a cell has few pieces; a piece is also in the cells that it nearly
// touches, because the walk of a ray along an edge may be in either cell.
//
// Immutable, read by any thread. Made in time linear in the entries of the grid. A box query costs the cells under the
// box, or all pieces if these are fewer; a ray costs the cells up to its hit.
//
// A uniform grid and no tree: walls of a building are of similar size and spread evenly, a walk from cell to cell needs
// no comparisons, and the index is arrays without pointers, which processes can share (RayMap).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <list>
#include <memory_resource>
#include <span>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/grid.h"
#include "common/spatial/grid_walk.h"
#include "common/spatial/ray_shape.h"
#include "common/spatial/walk_block.h"
#include "troupe/pixel_area.h"
#include "troupe/rectangle.h"

namespace troupe {

// PixelPieces: the pieces of the area of a static model's bitmap (PixelArea), each made when it is asked for, with the
// same bits as if MakePieces had listed them. They need less than two bytes for each pixel.
class PixelPieces {
 public:
  using Corners4 = std::array<Vec2, 4>;  // m, frame W, counter-clockwise

  // REQUIRES: the shape of the model has an area.
  PixelPieces(const WorldDescription& world, ModelId model, const Pose& X_WM);

  ModelId model() const { return model_; }
  const ZRange& z() const { return z_; }  // m, of the pieces, frame W
  double ranger_return() const { return ranger_return_; }
  // The heights of the pieces, m; empty if rays pass through them.
  const ZRange& ray_z() const { return ray_z_; }
  const Rectangle& bounds() const { return bounds_; }  // m, frame W

  // Calls visit(piece) for all pieces, in the order of the cover.
  template <typename Visit>
  void ForEach(Visit visit) const {
    area_.cover().ForEach([&](const PixelRectangle& r) { visit(PieceOf(CornersOf(r))); });
  }
  // Visits only the pieces whose bounding boxes overlap `box` (m, frame W; touching counts) and for which keep(corners)
  // is true.
  template <typename Visit, typename Keep>
  void ForEachNear(const Rectangle& box, std::pmr::memory_resource& memory, Keep keep, Visit visit) const;

  // Calls visit(pixels, distance) for the parts of the area that the ray passes and that have pieces, in order, with a
  // distance before which it does not enter each part, until `visit` returns false. Every piece that the ray hits
  // within `max_distance` has a pixel in a visited part whose distance is not beyond the hit.
  // REQUIRES: |direction| = 1
  template <typename Visit>
  void WalkRay(const Vec2& origin, const Vec2& direction, double max_distance, Visit visit) const {
    const Vec2 direction_A = X_MA_.InverseRotate(X_WM_.InverseRotate(direction));
    troupe::WalkRay(
        grid_, InArea(origin), direction_A, direction_A.array().inverse(), max_distance,
        [filled = filled_.data()](std::size_t cell) { return filled[cell]; },
        [&](std::size_t cell, double distance) { return visit(PixelsOf(cell), distance); });
  }
  // Calls visit(corners) for the pieces with a pixel among these.
  template <typename Visit>
  void ForEachIn(const PixelRectangle& pixels, Visit visit) const {
    area_.cover().ForEachIn(pixels, [&](const PixelRectangle& r) { visit(CornersOf(r)); });
  }

 private:
  Vec2 InArea(const Vec2& p_W) const { return X_MA_.InverseTransform(X_WM_.InverseTransform(p_W)); }
  Corners4 CornersOf(const PixelRectangle& r) const;
  ConvexPiece PieceOf(const Corners4& corners) const;
  // The rectangles with a pixel in the box, in the order of the cover.
  std::pmr::vector<PixelRectangle> RectanglesIn(const Rectangle& box_W, std::pmr::memory_resource& memory) const;
  PixelRectangle PixelsOf(std::size_t cell) const;
  void FillCells();

  PixelArea area_;
  Transform2 X_WM_;
  Transform2 X_MA_;
  bool turned_;
  ModelId model_;
  ZRange z_;  // m, frame W
  bool obstacle_;
  double ranger_return_;
  ZRange ray_z_;
  Rectangle bounds_ = Rectangle::Nothing();
  Grid grid_;                         // frame A, cells of some pixels
  std::vector<std::uint8_t> filled_;  // 1 for each cell that a piece reaches
};

// Appends the pieces of the model's area, if it has one with a height.
void AppendAreaPieces(const WorldDescription& world, ModelId model, const Pose& X_WM, std::vector<PixelPieces>& areas);

template <typename Visit, typename Keep>
void PixelPieces::ForEachNear(const Rectangle& box, std::pmr::memory_resource& memory, Keep keep, Visit visit) const {
  if (!bounds_.Overlaps(box)) return;
  for (const PixelRectangle& r : RectanglesIn(box, memory)) {
    const Corners4 corners = CornersOf(r);
    if (BoundingBox(corners).Overlaps(box) && keep(corners)) visit(PieceOf(corners));
  }
}

// The result of a query: pieces of the index, and pieces made for it. Valid as long as both.
class NearPieces {
 public:
  explicit NearPieces(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : pieces_(memory), made_(memory) {}

  void Clear() {
    pieces_.clear();
    made_.clear();
  }
  auto begin() const { return pieces_.begin(); }  // of const ConvexPiece*
  auto end() const { return pieces_.end(); }

 private:
  friend class StaticIndex;
  std::pmr::vector<const ConvexPiece*> pieces_;
  std::pmr::list<ConvexPiece> made_;
};

class StaticIndex {
 public:
  StaticIndex() = default;
  // Both in the order of their models.
  explicit StaticIndex(std::vector<ConvexPiece> pieces, std::vector<PixelPieces> areas = {});

  const Rectangle& bounds() const { return bounds_; }
  // The pieces that are kept, and the areas that the others are of.
  const std::vector<ConvexPiece>& kept_pieces() const { return pieces_; }
  const std::vector<PixelPieces>& areas() const { return areas_; }

  // Calls visit(piece) for all pieces, the pieces of areas last.
  template <typename Visit>
  void ForEachPiece(Visit visit) const {
    for (const ConvexPiece& piece : pieces_) visit(piece);
    for (const PixelPieces& area : areas_) area.ForEach(visit);
  }

  // Fills `result` with the pieces whose bounding boxes overlap `box` (touching counts): in the order of their models,
  // of a model the kept pieces first. Pieces of areas that do not themselves reach into the box may be left out.
  void Query(const Rectangle& box, NearPieces& result) const {
    Query(box, result, [](const PixelPieces::Corners4&) { return true; });
  }
  // Leaves out the pieces of areas for which keep(corners) is false, which saves making them.
  template <typename Keep>
  void Query(const Rectangle& box, NearPieces& result, Keep keep) const;

  // Starts the walks of rays over the kept pieces. REQUIRES: as WalkBlock::Start
  void StartWalks(const WalkBlock& rays, std::span<GridWalk> walks) const {
    if (pieces_.empty()) {
      std::fill(walks.begin(), walks.end(), GridWalk());
    } else {
      rays.Start(grid_, walks);
    }
  }
  // True only if no kept piece is in the box, or within the errors of a ray near it. Cheap: false for most large boxes.
  bool IsSurelyEmpty(const Rectangle& box) const {
    constexpr double kMargin = 1e-6;  // m, far above the rounding of a ray's end
    constexpr std::size_t kFewCells = 16;
    if (pieces_.empty()) return true;
    const CellRange range = grid_.CellsOf(box.Inflated(kMargin));
    if (range.count() > kFewCells) return false;
    for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
      for (std::int32_t column = range.min_column; column <= range.max_column; ++column) {
        if (ray_map_.filled()[grid_.CellAt(column, row)] != 0) return false;
      }
    }
    return true;
  }
  // The map of the kept pieces, by their indices.
  const RayMap& ray_map() const { return ray_map_; }
  void ShareRayMap(const FindEqualMemory& find) { ray_map_.Share(find); }

  // Calls visit(indices of kept pieces, distance) for the parts of the index that the ray passes and that have any, in
  // order, with a distance before which it does not enter each part, until `visit` returns false. Every kept piece that
  // the ray hits within `max_distance` is visited at a distance not beyond the hit; pieces may occur
  // several times. REQUIRES: |direction| = 1; inverse = 1 / direction by components
  template <typename Visit>
  void WalkRay(const Vec2& origin, const Vec2& direction, const Eigen::Array2d& inverse, double max_distance,
               Visit visit) const {
    if (pieces_.empty()) return;
    troupe::WalkRay(
        grid_, origin, direction, inverse, max_distance,
        [filled = ray_map_.filled()](std::size_t cell) { return filled[cell]; },
        [&](std::size_t cell, double distance) { return visit(ray_map_.PiecesInCell(cell), distance); });
  }

 private:
  // The cells whose neighbourhood the piece touches, because the walk of a ray along an edge may be in either cell.
  CellRange CellsOf(const ConvexPiece& piece) const;

  void FillCells(RayMapArrays& arrays) const;
  void QueryKept(const Rectangle& box, std::pmr::vector<const ConvexPiece*>& result) const;

  std::vector<ConvexPiece> pieces_;
  std::vector<PixelPieces> areas_;
  Rectangle bounds_ = Rectangle::Nothing();
  Rectangle kept_bounds_ = Rectangle::Nothing();
  Grid grid_;
  RayMap ray_map_;
};

template <typename Keep>
void StaticIndex::Query(const Rectangle& box, NearPieces& result, Keep keep) const {
  result.Clear();
  QueryKept(box, result.pieces_);
  const auto kept = static_cast<std::ptrdiff_t>(result.pieces_.size());
  for (const PixelPieces& area : areas_) {
    area.ForEachNear(box, *result.pieces_.get_allocator().resource(), keep, [&result](const ConvexPiece& piece) {
      result.pieces_.push_back(&result.made_.emplace_back(piece));
    });
  }
  if (result.made_.empty()) return;
  std::inplace_merge(result.pieces_.begin(), result.pieces_.begin() + kept, result.pieces_.end(),
                     [](const ConvexPiece* a, const ConvexPiece* b) { return a->model < b->model; });
}

}  // namespace troupe
