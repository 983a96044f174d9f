#include "troupe/rectangle_cover.h"

#include <limits>

#include "common/bitmap/pixel_runs.h"

namespace troupe {

std::optional<std::vector<PixelRectangle>> CoverByRectangles(const Bitmap& bitmap, std::size_t max_count) {
  // A run grows the rectangle above which it lies if it has the same ends, else it opens a new one. Rectangles are
  // opened in the order that is wanted of the result.
  std::vector<PixelRectangle> rectangles;
  std::vector<PixelRun> below;
  std::vector<PixelRun> runs;
  std::vector<std::size_t> rectangles_below;  // by run
  std::vector<std::size_t> rectangles_here;
  for (int y = 0; y < bitmap.height(); ++y) {
    FindRuns(bitmap.row(y), bitmap.width(), runs);
    rectangles_here.resize(runs.size());
    std::size_t candidate = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const PixelRun& run = runs[i];
      while (candidate < below.size() && below[candidate].x0 < run.x0) ++candidate;
      if (candidate < below.size() && below[candidate].x0 == run.x0 && below[candidate].x1 == run.x1) {
        rectangles_here[i] = rectangles_below[candidate];
        rectangles[rectangles_here[i]].y1 = y + 1;
      } else {
        if (rectangles.size() == max_count) return std::nullopt;
        rectangles_here[i] = rectangles.size();
        rectangles.push_back({run.x0, y, run.x1, y + 1});
      }
    }
    below.swap(runs);
    rectangles_below.swap(rectangles_here);
  }
  return rectangles;
}

std::vector<PixelRectangle> CoverByRectangles(const Bitmap& bitmap) {
  return *CoverByRectangles(bitmap, std::numeric_limits<std::size_t>::max());
}

}  // namespace troupe
