// DenseCover: the rectangles of CoverByRectangles, the same ones in the same order, in three bits for each pixel
// instead of a list: for bitmaps that have too many of them, as noise and checkerboards do.
//
// Why two forms of one cover: most maps have some thousand rectangles, for which a list with its indices is quickest; a
// scanned or noisy map has millions, for which a list takes gigabytes. Results must not depend on the form, so that
// order and bits are the same. Immutable; copies of a world share one.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "troupe/bitmap.h"
#include "troupe/rectangle_cover.h"

namespace troupe {

class DenseCover {
 public:
  explicit DenseCover(Bitmap bitmap);

  const Bitmap& bitmap() const { return bitmap_; }
  std::size_t count() const { return count_; }  // of rectangles
  // The bounds of the occupied pixels; all zero if there are none.
  const PixelRectangle& bounds() const { return bounds_; }

  // Calls visit(rectangle) for all rectangles, in order.
  template <typename Visit>
  void ForEach(Visit visit) const {
    ForEachIn({0, 0, bitmap_.width(), bitmap_.height()}, visit);
  }
  // Visits only the rectangles that have a pixel in `area`, in an order of their own. REQUIRES: area within the bitmap
  template <typename Visit>
  void ForEachIn(const PixelRectangle& area, Visit visit) const;

  bool operator==(const DenseCover& other) const { return bitmap_ == other.bitmap_; }

 private:
  // A bit for each pixel, column by column, so that a search along a column looks at 64 pixels at a time.
  class Columns {
   public:
    Columns(int width, int height);

    void Set(int x, int y) { words_[Index(x, y) >> 6] |= std::uint64_t{1} << (Index(x, y) & 63); }
    bool At(int x, int y) const { return (words_[Index(x, y) >> 6] >> (Index(x, y) & 63) & 1) != 0; }
    // The row of the nearest bit that is set, from y down or up. REQUIRES: there is one in the column
    int LastUpTo(int x, int y) const;
    int FirstFrom(int x, int y) const;

   private:
    std::size_t Index(int x, int y) const {
      return static_cast<std::size_t>(x) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(y);
    }
    int height_;
    std::vector<std::uint64_t> words_;
  };

  Bitmap bitmap_;
  // The first and the last row of each rectangle's first column.
  Columns first_rows_;
  Columns last_rows_;
  std::size_t count_ = 0;
  PixelRectangle bounds_;
};

template <typename Visit>
void DenseCover::ForEachIn(const PixelRectangle& area, Visit visit) const {
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = bitmap_.FirstFrom(area.x0, y, true); x < area.x1;) {
      const int x0 = x == area.x0 ? bitmap_.RunStart(x, y) : x;
      const int x1 = bitmap_.FirstFrom(x, y, false);
      // A rectangle is visited in its first row in the area.
      const bool opens = first_rows_.At(x0, y);
      if (opens || y == area.y0) {
        visit(PixelRectangle{x0, opens ? y : first_rows_.LastUpTo(x0, y), x1, last_rows_.FirstFrom(x0, y) + 1});
      }
      x = bitmap_.FirstFrom(x1, y, true);
    }
  }
}

}  // namespace troupe
