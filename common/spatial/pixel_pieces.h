// PixelPieces: the pieces of the area of a static model's bitmap (PixelArea), each made when it is asked for, with the
// same bits as if MakePieces had listed them. Needs less than two bytes for each pixel.
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "common/spatial/grid.h"
#include "common/spatial/ray_walk.h"
#include "troupe/pixel_area.h"

namespace troupe {

class PixelPieces {
 public:
  using Corners4 = std::array<Vec2, 4>;  // m, frame W, counter-clockwise

  // REQUIRES: the shape of the model has an area.
  PixelPieces(const WorldDescription& world, ModelId model, const Pose& X_WM);

  ModelId model() const { return model_; }
  const ZRange& z() const { return z_; }  // m, of the pieces, frame W
  double ranger_return() const { return ranger_return_; }
  // Of the pieces, m; empty if rays look through them.
  const ZRange& ray_z() const { return ray_z_; }
  const Rectangle& bounds() const { return bounds_; }  // m, frame W

  // Calls visit(piece) for all pieces, in the order of the cover.
  template <typename Visit>
  void ForEach(Visit visit) const {
    area_.cover().ForEach([&](const PixelRectangle& r) { visit(PieceOf(CornersOf(r))); });
  }
  // The same for those whose bounding boxes overlap `box` (m, frame W; touching counts) and for which keep(corners) is
  // true.
  template <typename Visit, typename Keep>
  void ForEachNear(const Rectangle& box, std::pmr::memory_resource& memory, Keep keep, Visit visit) const;

  // Calls visit(pixels, distance) for the parts of the area that the ray passes and that have pieces, in order, with a
  // distance before which it does not enter each part, until `visit` returns false. Every piece that the ray hits
  // within `max_distance` has a pixel in one of those visited at a distance not beyond the hit.
  // REQUIRES: |direction| = 1
  template <typename Visit>
  void WalkRay(const Vec2& origin, const Vec2& direction, double max_distance, Visit visit) const {
    const Vec2 direction_A = X_MA_.InverseRotate(X_WM_.InverseRotate(direction));
    troupe::WalkRay(
        grid_, InArea(origin), direction_A, direction_A.array().inverse(), max_distance,
        [this](std::size_t cell) { return filled_[cell]; },
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

}  // namespace troupe
