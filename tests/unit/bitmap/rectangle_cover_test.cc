#include "troupe/rectangle_cover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "troupe/random.h"

namespace troupe {
namespace {

// Rows from the top, '#' is occupied.
Bitmap FromText(const std::vector<std::string>& rows) {
  Bitmap bitmap(static_cast<int>(rows.front().size()), static_cast<int>(rows.size()));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t x = 0; x < rows[row].size(); ++x) {
      if (rows[row][x] == '#') {
        bitmap.set_occupied(static_cast<int>(x), static_cast<int>(rows.size() - 1 - row), true);
      }
    }
  }
  return bitmap;
}

// Each pixel is covered as often as it is occupied: once or never.
void ExpectExactCover(const Bitmap& bitmap, const std::vector<PixelRectangle>& rectangles) {
  std::vector<int> covered(static_cast<std::size_t>(bitmap.width()) * static_cast<std::size_t>(bitmap.height()));
  const auto at = [&](int x, int y) -> int& {
    return covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(bitmap.width()) +
                   static_cast<std::size_t>(x)];
  };
  for (const PixelRectangle& r : rectangles) {
    ASSERT_TRUE(r.x0 >= 0 && r.x0 < r.x1 && r.x1 <= bitmap.width());
    ASSERT_TRUE(r.y0 >= 0 && r.y0 < r.y1 && r.y1 <= bitmap.height());
    for (int y = r.y0; y < r.y1; ++y) {
      for (int x = r.x0; x < r.x1; ++x) ++at(x, y);
    }
  }
  for (int y = 0; y < bitmap.height(); ++y) {
    for (int x = 0; x < bitmap.width(); ++x) ASSERT_EQ(at(x, y), bitmap.occupied(x, y) ? 1 : 0) << x << "," << y;
  }
  EXPECT_TRUE(std::is_sorted(rectangles.begin(), rectangles.end(),
                             [](const auto& a, const auto& b) { return a.y0 != b.y0 ? a.y0 < b.y0 : a.x0 < b.x0; }));
}

TEST(RectangleCover, AnEmptyBitmapHasNoRectangles) {
  EXPECT_TRUE(CoverByRectangles(Bitmap()).empty());
  EXPECT_TRUE(CoverByRectangles(Bitmap(100, 50)).empty());
}

TEST(RectangleCover, FullBitmapIsOneRectangle) {
  for (const int width : {1, 63, 64, 65, 128, 200}) {
    Bitmap bitmap(width, 3);
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < width; ++x) bitmap.set_occupied(x, y, true);
    }
    const std::vector<PixelRectangle> expected = {{0, 0, width, 3}};
    EXPECT_EQ(CoverByRectangles(bitmap), expected);
  }
}

TEST(RectangleCover, FrameIsFourRectangles) {
  const Bitmap bitmap = FromText({"#####", "#...#", "#...#", "#####"});
  const std::vector<PixelRectangle> expected = {{0, 0, 5, 1}, {0, 1, 1, 3}, {4, 1, 5, 3}, {0, 3, 5, 4}};
  EXPECT_EQ(CoverByRectangles(bitmap), expected);
}

TEST(RectangleCover, DiagonalPixelsStayApart) {
  const std::vector<PixelRectangle> expected = {{0, 0, 1, 1}, {1, 1, 2, 2}};
  EXPECT_EQ(CoverByRectangles(FromText({".#", "#."})), expected);
}

TEST(RectangleCover, RunsThatTouchWordEndsAreWhole) {
  Bitmap bitmap(256, 1);
  for (int x = 60; x < 192; ++x) bitmap.set_occupied(x, 0, true);
  const std::vector<PixelRectangle> expected = {{60, 0, 192, 1}};
  EXPECT_EQ(CoverByRectangles(bitmap), expected);
}

TEST(RectangleCover, EqualRunsWithAGapBetweenDoNotMerge) {
  const std::vector<PixelRectangle> expected = {{0, 0, 2, 1}, {0, 2, 2, 3}};
  EXPECT_EQ(CoverByRectangles(FromText({"##.", "...", "##."})), expected);
}

TEST(RectangleCover, RandomBitmapsAreCoveredExactly) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const int width = 1 + static_cast<int>(RandomBits({seed, 1}) % 150);
    const int height = 1 + static_cast<int>(RandomBits({seed, 2}) % 40);
    const double density = RandomUniform({seed, 3});
    Bitmap bitmap(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::uint64_t block = seed % 3;  // pixels, or patches of 2 or 4 pixels
        const auto cx = static_cast<std::uint64_t>(x) >> block;
        const auto cy = static_cast<std::uint64_t>(y) >> block;
        bitmap.set_occupied(x, y, RandomUniform({seed, cx, cy}) < density);
      }
    }
    ExpectExactCover(bitmap, CoverByRectangles(bitmap));
  }
}

}  // namespace
}  // namespace troupe
