// From pixels to few rectangles.
#pragma once

#include <vector>

#include "common/bitmap/bitmap.h"

namespace troupe {

// Pixels x0 <= x < x1, y0 <= y < y1.
struct PixelRectangle {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
  bool operator==(const PixelRectangle&) const = default;
};

// An exact cover of the occupied pixels by disjoint rectangles: every occupied pixel is in exactly one, no free pixel
// in any. Few, in a fixed order (by y0, then x0).
std::vector<PixelRectangle> CoverByRectangles(const Bitmap& bitmap);

}  // namespace troupe
