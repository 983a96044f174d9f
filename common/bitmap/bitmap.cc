#include "troupe/bitmap.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/geometry/limits.h"
#include "troupe/check.h"
#include "troupe/pixel_area.h"

namespace troupe {
namespace {

// Far above the rounding of a line's place, which is below 1e-9 m, and with it of a pixel's number.
constexpr double kMinPixel = 1e-6;        // m
constexpr double kPixelTolerance = 0.01;  // pixels

struct PixelRange {
  int first;
  int end;
};

PixelRange PixelsBetween(const PixelLines& lines, double min, double max, int count) {
  const double start = lines(0);
  const double first = std::floor((min - start) / lines.spacing() - kPixelTolerance);
  const double end = std::floor((max - start) / lines.spacing() + kPixelTolerance) + 1.0;
  const auto pixels = static_cast<double>(count);
  return {static_cast<int>(std::clamp(first, 0.0, pixels)), static_cast<int>(std::clamp(end, 0.0, pixels))};
}

void Stretch(PixelLines& lines, double center, double factor) {
  // The first stretch that changes anything is kept apart from the second: a line's place is computed by the same
  // operations as a listed edge's, because their product would have other bits.
  const bool is_first = lines.center == 0.0 && lines.factor == 1.0;
  TROUPE_CHECK(is_first || (lines.second_center == 0.0 && lines.second_factor == 1.0));
  (is_first ? lines.center : lines.second_center) = center;
  (is_first ? lines.factor : lines.second_factor) = factor;
}

bool IsWithin(double number, double limit) {
  return std::abs(number) <= limit;  // false for NaN
}

bool AreUsable(const PixelLines& lines, int count) {
  const auto stretched = [&](int line) { return (line - lines.center) * lines.factor; };
  return IsWithin(lines.center, 0x1p31) && IsWithin(lines.second_center, kMaxMagnitude) &&
         IsWithin(lines.shift, kMaxMagnitude) && IsWithin(stretched(0), kMaxMagnitude) &&
         IsWithin(stretched(count), kMaxMagnitude) && lines.factor >= kMinPixel && lines.spacing() >= kMinPixel &&
         IsWithin(lines(0), kMaxMagnitude) && IsWithin(lines(count), kMaxMagnitude);
}

}  // namespace

Bitmap::Bitmap(int width, int height)
    : width_(width), height_(height), stride_((static_cast<std::int64_t>(width) + 63) / 64 * 64) {
  TROUPE_CHECK(width >= 0 && height >= 0);
  words_.resize(words_per_row() * static_cast<std::size_t>(height));
}

void Bitmap::set_occupied(int x, int y, bool value) {
  const std::size_t i = Index(x, y);
  const std::uint64_t bit = std::uint64_t{1} << (i & 63);
  if (value) {
    words_[i >> 6] |= bit;
  } else {
    words_[i >> 6] &= ~bit;
  }
}

int Bitmap::FirstFrom(int x, int y, bool value) const {
  const std::span<const std::uint64_t> words = row(y);
  const std::uint64_t flip = value ? 0 : ~std::uint64_t{0};
  std::size_t i = static_cast<std::size_t>(x) >> 6;
  if (i >= words.size()) return width_;
  // Bits before x are cleared; a free pixel is found as an occupied one of the flipped row. The bits beyond the width,
  // which are 0, may be found as free: hence the minimum with the width.
  std::uint64_t word = (words[i] ^ flip) >> (x & 63) << (x & 63);
  while (word == 0) {
    if (++i == words.size()) return width_;
    word = words[i] ^ flip;
  }
  return std::min(width_, static_cast<int>(i << 6) + std::countr_zero(word));
}

int Bitmap::RunStart(int x, int y) const {
  const std::span<const std::uint64_t> words = row(y);
  std::size_t i = static_cast<std::size_t>(x) >> 6;
  std::uint64_t free = ~words[i] << (63 - (x & 63));  // its highest bit is x
  int last = x;
  while (free == 0) {
    if (i == 0) return 0;
    last = static_cast<int>(i << 6) - 1;
    free = ~words[--i];
  }
  return last - std::countl_zero(free) + 1;
}

void Bitmap::Pack(std::span<std::uint64_t> bits) const {
  for (int y = 0; y < height_; ++y) {
    std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    // A row begins at any bit of the packed words: each word is split in two by a shift.
    for (const std::uint64_t word : row(y)) {
      bits[at >> 6] |= word << (at & 63);
      const std::uint64_t rest = (at & 63) == 0 ? 0 : word >> (64 - (at & 63));
      if (rest != 0) bits[(at >> 6) + 1] |= rest;
      at += 64;
    }
  }
}

Bitmap Bitmap::Unpacked(int width, int height, std::span<const std::uint64_t> bits) {
  Bitmap bitmap(width, height);
  for (int y = 0; y < height; ++y) {
    std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    const std::size_t end = at + static_cast<std::size_t>(width);
    for (std::uint64_t& word : bitmap.row(y)) {
      const std::size_t count = std::min<std::size_t>(64, end - at);
      const std::size_t shift = at & 63;
      word = bits[at >> 6] >> shift;
      if (shift + count > 64) word |= bits[(at >> 6) + 1] << (64 - shift);
      if (count < 64) word &= (std::uint64_t{1} << count) - 1;
      at += count;
    }
  }
  return bitmap;
}

PixelRectangle PixelArea::PixelsIn(const Rectangle& box) const {
  const Bitmap& bitmap = cover_->bitmap();
  const PixelRange x = PixelsBetween(x_, box.min_x, box.max_x, bitmap.width());
  const PixelRange y = PixelsBetween(y_, box.min_y, box.max_y, bitmap.height());
  return {x.first, y.first, x.end, y.end};
}

PixelArea PixelArea::Stretched(const Vec2& center, const Vec2& factor) const {
  PixelArea result = *this;
  Stretch(result.x_, center.x(), factor.x());
  Stretch(result.y_, center.y(), factor.y());
  return result;
}

PixelArea PixelArea::Moved(const Pose& X_MD) const {
  PixelArea result = *this;
  if (X_MD.heading == 0.0) {
    result.x_.shift = X_MD.x;
    result.y_.shift = X_MD.y;
  } else {
    result.X_MA_ = {X_MD.x, X_MD.y, 0.0, X_MD.heading};
  }
  return result;
}

Status PixelArea::Check() const {
  const auto fault = [](const char* message) { return Error{{}, message}; };
  if (cover_->count() == 0) return fault("a bitmap has no occupied pixel");
  const bool usable = AreUsable(x_, cover_->bitmap().width()) && AreUsable(y_, cover_->bitmap().height());
  if (!usable) return fault("a pixel of its bitmap has no area, or is beyond 1000 km");
  if (!IsFinite(X_MA_) || X_MA_.z != 0.0) return fault("the pose of a bitmap is not finite, or not at height 0");
  const Transform2 transform(X_MA_);
  const Rectangle box = bounds();
  for (const Vec2& corner : {Vec2(box.min_x, box.min_y), Vec2(box.max_x, box.min_y), Vec2(box.max_x, box.max_y),
                             Vec2(box.min_x, box.max_y)}) {
    if ((transform * corner).cwiseAbs().maxCoeff() > kMaxMagnitude) return fault("a bitmap reaches beyond 1000 km");
  }
  return Status();
}

}  // namespace troupe
