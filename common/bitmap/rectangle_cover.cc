#include "troupe/rectangle_cover.h"

#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "troupe/dense_cover.h"

namespace troupe {
namespace {

// Runs: the stretches of occupied pixels of a row.

// Pixels x0 <= x < x1 of a row.
struct PixelRun {
  int x0 = 0;
  int x1 = 0;
};

// Replaces `runs` by the runs of a row (Bitmap::row), from left to right. Looks at a word at a time, so that free and
// full areas cost next to nothing.
void FindRuns(std::span<const std::uint64_t> row, int width, std::vector<PixelRun>& runs) {
  runs.clear();
  bool inside = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::uint64_t word = row[i];
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
        runs.push_back({base + bit, width});
      }
      inside = !inside;
    }
  }
}

}  // namespace

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

DenseCover::Columns::Columns(int width, int height) : height_(height) {
  words_.resize((static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 63) / 64);
}

int DenseCover::Columns::LastUpTo(int x, int y) const {
  const std::size_t index = Index(x, y);
  std::size_t i = index >> 6;
  std::uint64_t word = words_[i] << (63 - (index & 63));
  if (word != 0) return y - std::countl_zero(word);
  while (words_[--i] == 0) {
  }
  return y - static_cast<int>(index - (i * 64 + 63 - static_cast<std::size_t>(std::countl_zero(words_[i]))));
}

int DenseCover::Columns::FirstFrom(int x, int y) const {
  const std::size_t index = Index(x, y);
  std::size_t i = index >> 6;
  const std::uint64_t word = words_[i] >> (index & 63);
  if (word != 0) return y + std::countr_zero(word);
  while (words_[++i] == 0) {
  }
  return y + static_cast<int>(i * 64 + static_cast<std::size_t>(std::countr_zero(words_[i])) - index);
}

DenseCover::DenseCover(Bitmap bitmap)
    : bitmap_(std::move(bitmap)),
      first_rows_(bitmap_.width(), bitmap_.height()),
      last_rows_(bitmap_.width(), bitmap_.height()) {
  std::vector<PixelRun> below;
  std::vector<PixelRun> runs;
  for (int y = 0; y <= bitmap_.height(); ++y) {
    runs.clear();
    if (y < bitmap_.height()) FindRuns(bitmap_.row(y), bitmap_.width(), runs);
    // Runs without an equal one in the row above or below end a rectangle or begin one.
    std::size_t here = 0;
    for (const PixelRun& run : below) {
      while (here < runs.size() && runs[here].x0 < run.x0) ++here;
      const bool continues = here < runs.size() && runs[here].x0 == run.x0 && runs[here].x1 == run.x1;
      if (!continues) last_rows_.Set(run.x0, y - 1);
    }
    std::size_t candidate = 0;
    for (const PixelRun& run : runs) {
      while (candidate < below.size() && below[candidate].x0 < run.x0) ++candidate;
      const bool continues = candidate < below.size() && below[candidate].x0 == run.x0 && below[candidate].x1 == run.x1;
      if (continues) continue;
      first_rows_.Set(run.x0, y);
      ++count_;
    }
    if (!runs.empty()) {
      const bool first = bounds_.x1 == 0;
      bounds_ = {first ? runs.front().x0 : std::min(bounds_.x0, runs.front().x0), first ? y : bounds_.y0,
                 std::max(bounds_.x1, runs.back().x1), y + 1};
    }
    below.swap(runs);
  }
}

}  // namespace troupe
