#include "troupe/pixel_area.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/limits.h"
#include "troupe/check.h"

namespace troupe {
namespace {

// Far above the rounding of a line's place, which is below 1e-9 m, and with it of a pixel's number.
constexpr double kSmallestPixel = 1e-6;  // m
constexpr double kHair = 0.01;           // pixels

struct PixelRange {
  int first;
  int end;
};

PixelRange PixelsBetween(const PixelLines& lines, double min, double max, int count) {
  const double start = lines(0);
  const double first = std::floor((min - start) / lines.spacing() - kHair);
  const double end = std::floor((max - start) / lines.spacing() + kHair) + 1.0;
  const auto pixels = static_cast<double>(count);
  return {static_cast<int>(std::clamp(first, 0.0, pixels)), static_cast<int>(std::clamp(end, 0.0, pixels))};
}

void Stretch(PixelLines& lines, double center, double factor) {
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
         IsWithin(stretched(count), kMaxMagnitude) && lines.factor >= kSmallestPixel &&
         lines.spacing() >= kSmallestPixel && IsWithin(lines(0), kMaxMagnitude) &&
         IsWithin(lines(count), kMaxMagnitude);
}

}  // namespace

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
