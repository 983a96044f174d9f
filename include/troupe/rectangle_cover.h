// From pixels to few rectangles.
//
// Bitmaps become bodies by these rectangles: their number decides on memory and time of a map, their order on ids of
// pieces, and so on which of two equal hits is reported. Hence a simple rule with a fixed order (runs that continue in
// the next row) instead of a smallest cover, which would take longer to find than it saves. Linear in pixels / 64 plus
// rectangles.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "troupe/bitmap.h"

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
// in any. Few, in a fixed order (by y0, then x0). A rectangle is a run of a row with all equal runs in the rows that
// follow without a gap.
std::vector<PixelRectangle> CoverByRectangles(const Bitmap& bitmap);

// The same; nothing if there are more than `max_count`, for which no memory is needed then.
std::optional<std::vector<PixelRectangle>> CoverByRectangles(const Bitmap& bitmap, std::size_t max_count);

}  // namespace troupe
