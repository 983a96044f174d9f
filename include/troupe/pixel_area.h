// PixelArea: the occupied pixels of a bitmap in the plane, in metres, without a list of their rectangles.
//
// A rectangle of the area has the same bits as the edge that a list of rectangles would have after the same operations
// (PixelLines), so that a world is the same world with either form. Frame A: the axes of the pixel lines; frame M: the
// model's. A turned area has X_MA with a heading: its rectangles are then polygons in M.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "troupe/dense_cover.h"
#include "troupe/pose.h"
#include "troupe/rectangle.h"
#include "troupe/result.h"

namespace troupe {

// The places of the lines between the pixels along one axis. Each step of the import of a bitmap is one of these
// operations, in this order, so that a line has the same bits as the edge of a rectangle that took them one by one.
struct PixelLines {
  double center = 0.0;         // pixels
  double factor = 1.0;         // m for each pixel
  double second_center = 0.0;  // m
  double second_factor = 1.0;
  double shift = -0.0;  // m; adding -0.0 changes no number

  // m; line 0 is at the start of pixel 0.
  double operator()(int line) const { return ((line - center) * factor - second_center) * second_factor + shift; }
  double spacing() const { return factor * second_factor; }  // m
  bool operator==(const PixelLines&) const = default;
};

class PixelArea {
 public:
  // X_MA: the pose of the axes of the lines in the model's frame M.
  PixelArea(std::shared_ptr<const DenseCover> cover, const PixelLines& x, const PixelLines& y, const Pose& X_MA = {})
      : cover_(std::move(cover)), x_(x), y_(y), X_MA_(X_MA) {}

  const DenseCover& cover() const { return *cover_; }
  const PixelLines& x() const { return x_; }
  const PixelLines& y() const { return y_; }
  const Pose& X_MA() const { return X_MA_; }

  // m, frame A.
  Rectangle InMetres(const PixelRectangle& r) const { return {x_(r.x0), y_(r.y0), x_(r.x1), y_(r.y1)}; }
  Rectangle bounds() const { return InMetres(cover_->bounds()); }
  // Calls visit(rectangle) for all rectangles of the cover, in order; m, frame A.
  template <typename Visit>
  void ForEach(Visit visit) const {
    cover_->ForEach([&](const PixelRectangle& r) { visit(InMetres(r)); });
  }
  // The pixels that a box (m, frame A) overlaps or touches; a few more may be among them.
  PixelRectangle PixelsIn(const Rectangle& box) const;

  // Stretched about a centre, which moves to 0. REQUIRES: called at most twice, and before Moved
  PixelArea Stretched(const Vec2& center, const Vec2& factor) const;
  // Moved by X_MD, from frame D, which A is equal to, to M. A heading of 0 keeps the axes of M.
  PixelArea Moved(const Pose& X_MD) const;

  // Checks that there are pixels, at least 1 um wide and within the reach of a world. For areas from a peer or a file;
  // the functions above are exact for no others.
  Status Check() const;

  bool operator==(const PixelArea& other) const {
    return x_ == other.x_ && y_ == other.y_ && X_MA_ == other.X_MA_ &&
           (cover_ == other.cover_ || *cover_ == *other.cover_);
  }

 private:
  std::shared_ptr<const DenseCover> cover_;  // copies of a world share it
  PixelLines x_;
  PixelLines y_;
  Pose X_MA_;
};

}  // namespace troupe
