#include "troupe/dense_cover.h"

#include <utility>

#include "common/bitmap/pixel_runs.h"

namespace troupe {

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
