#include "common/bitmap/rectangle_cover.h"

#include <bit>
#include <span>

namespace troupe {
namespace {

// Pixels x0 <= x < x1 of a row, and the rectangle that they belong to.
struct Run {
  int x0 = 0;
  int x1 = 0;
  std::size_t rectangle = 0;
};

// The runs of occupied pixels of a row, from left to right. Looks at a word at a time, so that free and full areas cost
// next to nothing.
void FindRuns(std::span<const std::uint64_t> words, int width, std::vector<Run>& runs) {
  runs.clear();
  bool inside = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::uint64_t word = words[i];
    if (word == (inside ? ~std::uint64_t{0} : 0)) continue;
    const int base = static_cast<int>(i * 64);
    int bit = 0;
    while (bit < 64) {
      const std::uint64_t changed = (inside ? ~word : word) >> bit;
      if (changed == 0) break;
      bit += std::countr_zero(changed);
      if (inside) {
        runs.back().x1 = base + bit;
      } else {
        runs.push_back({base + bit, width, 0});
      }
      inside = !inside;
    }
  }
}

}  // namespace

std::vector<PixelRectangle> CoverByRectangles(const Bitmap& bitmap) {
  // A run grows the rectangle above which it lies if it has the same ends, else it opens a new one. Rectangles are
  // opened in the order that is wanted of the result.
  std::vector<PixelRectangle> rectangles;
  std::vector<Run> below;
  std::vector<Run> runs;
  for (int y = 0; y < bitmap.height(); ++y) {
    FindRuns(bitmap.row(y), bitmap.width(), runs);
    std::size_t candidate = 0;
    for (Run& run : runs) {
      while (candidate < below.size() && below[candidate].x0 < run.x0) ++candidate;
      if (candidate < below.size() && below[candidate].x0 == run.x0 && below[candidate].x1 == run.x1) {
        run.rectangle = below[candidate].rectangle;
        rectangles[run.rectangle].y1 = y + 1;
      } else {
        run.rectangle = rectangles.size();
        rectangles.push_back({run.x0, y, run.x1, y + 1});
      }
    }
    below.swap(runs);
  }
  return rectangles;
}

}  // namespace troupe
