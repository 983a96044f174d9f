#include "common/picture/pixel_mask.h"

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

constexpr int kMaxCells = 4096;  // along each side

// Where the pixels of an area are on the page: pixel (i, j) begins at origin + i * along_x + j * along_y.
struct PagePlacement {
  Vec2 origin;
  Vec2 along_x;
  Vec2 along_y;
};

PagePlacement Placement(const PixelArea& area, const Pose& X_WM, const Viewport& viewport) {
  const Transform2 model(X_WM);
  const Transform2 lines(area.X_MA());
  const auto on_page = [&](int i, int j) { return viewport.ToPage(model * (lines * Vec2(area.x()(i), area.y()(j)))); };
  const int width = area.cover().bitmap().width();
  const int height = area.cover().bitmap().height();
  const Vec2 origin = on_page(0, 0);
  return {origin, (on_page(width, 0) - origin) / width, (on_page(0, height) - origin) / height};
}

// The pixels of the bitmap that may be in the box on the page.
PixelRectangle PixelsIn(const Rectangle& box, const PagePlacement& placement, const PixelRectangle& bounds) {
  const double area = Cross(placement.along_x, placement.along_y);
  Rectangle pixels = Rectangle::Nothing();
  for (const Vec2& corner : Corners(box)) {
    const Vec2 from = corner - placement.origin;
    pixels.Extend(Vec2(Cross(from, placement.along_y) / area, Cross(placement.along_x, from) / area));
  }
  const auto clamped = [](double pixel, int min, int max) {
    return static_cast<int>(std::clamp(pixel, static_cast<double>(min), static_cast<double>(max)));
  };
  return {
      clamped(std::floor(pixels.min_x), bounds.x0, bounds.x1), clamped(std::floor(pixels.min_y), bounds.y0, bounds.y1),
      clamped(std::ceil(pixels.max_x), bounds.x0, bounds.x1), clamped(std::ceil(pixels.max_y), bounds.y0, bounds.y1)};
}

// Adds the occupied pixels of a row to the cells that they are in, `step` pixels wide.
void CountRow(const Bitmap& bitmap, int y, const PixelRectangle& part, int step, std::vector<std::uint32_t>& counts) {
  for (int x = bitmap.FirstFrom(part.x0, y, true); x < part.x1;) {
    const int end = std::min(bitmap.FirstFrom(x, y, false), part.x1);
    while (x < end) {
      const int cell = (x - part.x0) / step;
      const int next = std::min(end, part.x0 + (cell + 1) * step);
      counts[static_cast<std::size_t>(cell)] += static_cast<std::uint32_t>(next - x);
      x = next;
    }
    x = bitmap.FirstFrom(end, y, true);
  }
}

}  // namespace

PixelMask MakePixelMask(const PixelArea& area, const Pose& X_WM, const Viewport& viewport) {
  const PagePlacement placement = Placement(area, X_WM, viewport);
  const PixelRectangle part = PixelsIn(viewport.plot, placement, area.cover().bounds());
  PixelMask mask;
  if (part.x0 >= part.x1 || part.y0 >= part.y1) return mask;
  // Cells of half a page's pixel, or of a pixel of the bitmap where that is larger.
  const double finest = 0.5 / std::max(placement.along_x.norm(), placement.along_y.norm());
  const int longest = std::max(part.x1 - part.x0, part.y1 - part.y0);
  const int step =
      std::max(static_cast<int>(std::clamp(finest, 1.0, static_cast<double>(longest))), (longest - 1) / kMaxCells + 1);
  mask.width = (part.x1 - part.x0 - 1) / step + 1;
  mask.height = (part.y1 - part.y0 - 1) / step + 1;
  mask.origin = placement.origin + part.x0 * placement.along_x + part.y0 * placement.along_y;
  mask.along_x = step * placement.along_x;
  mask.along_y = step * placement.along_y;
  mask.sharp = step == 1;
  mask.coverage.reserve(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  const double full = static_cast<double>(step) * step;
  std::vector<std::uint32_t> counts;
  for (int row = 0; row < mask.height; ++row) {
    counts.assign(static_cast<std::size_t>(mask.width), 0);
    const int first = part.y0 + row * step;
    for (int y = first; y < std::min(first + step, part.y1); ++y) {
      CountRow(area.cover().bitmap(), y, part, step, counts);
    }
    for (const std::uint32_t count : counts) {
      mask.coverage.push_back(static_cast<std::uint8_t>(std::lround(255.0 * count / full)));
    }
  }
  return mask;
}

}  // namespace troupe
