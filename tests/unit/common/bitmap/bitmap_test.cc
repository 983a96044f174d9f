#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "troupe/dense_cover.h"
#include "troupe/pixel_area.h"
#include "troupe/random.h"
#include "troupe/rectangle_cover.h"

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

// A share of the pixels is occupied; `side`: pixels of a blot.
Bitmap Noise(int width, int height, double share, int side, std::uint64_t seed) {
  Bitmap bitmap(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto column = static_cast<std::uint64_t>(x / side);
      const auto row = static_cast<std::uint64_t>(y / side);
      bitmap.set_occupied(x, y, RandomUniform({seed, column, row}) < share);
    }
  }
  return bitmap;
}

std::vector<PixelRectangle> RectanglesIn(const DenseCover& cover, const PixelRectangle& area) {
  std::vector<PixelRectangle> result;
  cover.ForEachIn(area, [&](const PixelRectangle& r) { result.push_back(r); });
  std::sort(result.begin(), result.end(), [](const PixelRectangle& a, const PixelRectangle& b) {
    return std::tie(a.y0, a.x0) < std::tie(b.y0, b.x0);
  });
  return result;
}

std::vector<PixelRectangle> Overlapping(const std::vector<PixelRectangle>& rectangles, const PixelRectangle& area) {
  std::vector<PixelRectangle> result;
  for (const PixelRectangle& r : rectangles) {
    if (r.x0 < area.x1 && area.x0 < r.x1 && r.y0 < area.y1 && area.y0 < r.y1) result.push_back(r);
  }
  return result;
}

void ExpectSameCover(const Bitmap& bitmap, std::uint64_t seed) {
  const std::vector<PixelRectangle> expected = CoverByRectangles(bitmap);
  const DenseCover cover(bitmap);
  EXPECT_EQ(cover.count(), expected.size());
  std::vector<PixelRectangle> all;
  cover.ForEach([&](const PixelRectangle& r) { all.push_back(r); });
  EXPECT_EQ(all, expected);
  PixelRectangle bounds;
  for (const PixelRectangle& r : expected) {
    if (bounds.x1 == 0) bounds = r;
    bounds = {std::min(bounds.x0, r.x0), std::min(bounds.y0, r.y0), std::max(bounds.x1, r.x1),
              std::max(bounds.y1, r.y1)};
  }
  EXPECT_EQ(cover.bounds(), bounds);
  for (std::uint64_t i = 0; i < 40; ++i) {
    const auto pick = [&](std::uint64_t component, int count) {
      return static_cast<int>(RandomUniform({seed, i, component}) * (count + 1));
    };
    PixelRectangle area{pick(0, bitmap.width()), pick(1, bitmap.height()), pick(2, bitmap.width()),
                        pick(3, bitmap.height())};
    if (area.x0 > area.x1) std::swap(area.x0, area.x1);
    if (area.y0 > area.y1) std::swap(area.y0, area.y1);
    if (area.x0 == area.x1 || area.y0 == area.y1) continue;
    EXPECT_EQ(RectanglesIn(cover, area), Overlapping(expected, area));
  }
}

TEST(DenseCover, HasTheRectanglesOfTheList) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const int width = 1 + static_cast<int>(RandomUniform({seed, 1}) * 200.0);
    const int height = 1 + static_cast<int>(RandomUniform({seed, 2}) * 200.0);
    const int side = 1 + static_cast<int>(RandomUniform({seed, 3}) * 20.0);
    SCOPED_TRACE(seed);
    ExpectSameCover(Noise(width, height, 0.1 + 0.8 * RandomUniform({seed, 4}), side, seed), seed);
  }
}

TEST(DenseCover, HasTheRectanglesOfLinesAndCheckerboards) {
  for (const auto& [width, height] : {std::pair(1, 500), std::pair(500, 1), std::pair(130, 129), std::pair(64, 64)}) {
    Bitmap checkerboard(width, height);
    Bitmap full(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        checkerboard.set_occupied(x, y, (x + y) % 2 == 0);
        full.set_occupied(x, y, true);
      }
    }
    ExpectSameCover(checkerboard, 1);
    ExpectSameCover(full, 2);
    ExpectSameCover(Bitmap(width, height), 3);
  }
}

TEST(CoverByRectangles, GivesUpAtTheLimit) {
  const Bitmap bitmap = Noise(100, 100, 0.5, 1, 7);
  const std::size_t count = CoverByRectangles(bitmap).size();
  EXPECT_EQ(CoverByRectangles(bitmap, count), CoverByRectangles(bitmap));
  EXPECT_FALSE(CoverByRectangles(bitmap, count - 1));
}

TEST(Bitmap, PacksItsPixelsWithoutGaps) {
  for (const int width : {1, 7, 63, 64, 65, 128, 200}) {
    const Bitmap bitmap = Noise(width, 37, 0.5, 1, static_cast<std::uint64_t>(width));
    std::vector<std::uint64_t> bits(Bitmap::WordsOf(width, 37));
    bitmap.Pack(bits);
    for (int y = 0; y < 37; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        ASSERT_EQ((bits[i / 64] >> (i % 64) & 1) != 0, bitmap.occupied(x, y));
      }
    }
    EXPECT_EQ(Bitmap::Unpacked(width, 37, bits), bitmap);
    // Bits beyond the last pixel do not count.
    bits.back() |= (width * 37) % 64 == 0 ? 0 : ~std::uint64_t{0} << ((width * 37) % 64);
    EXPECT_EQ(Bitmap::Unpacked(width, 37, bits), bitmap);
  }
}

std::shared_ptr<const DenseCover> Checkerboard(int width, int height) {
  Bitmap bitmap(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) bitmap.set_occupied(x, y, (x + y) % 2 == 0);
  }
  return std::make_shared<const DenseCover>(std::move(bitmap));
}

TEST(PixelArea, PlacesLinesByTheStepsOfTheImport) {
  const PixelArea area = PixelArea(Checkerboard(7, 5), {}, {})
                             .Stretched({3.5, 2.5}, {0.3 / 7.0, 0.2 / 5.0})
                             .Stretched({0.01, 0.0}, {0.9, 1.1})
                             .Moved({0.1, 0.2, 0.0, 0.0});
  EXPECT_EQ(area.x()(3), ((3.0 - 3.5) * (0.3 / 7.0) - 0.01) * 0.9 + 0.1);
  EXPECT_EQ(area.y()(5), (5.0 - 2.5) * (0.2 / 5.0) * 1.1 + 0.2);
  EXPECT_TRUE(area.Check().ok());
}

TEST(PixelArea, FindsThePixelsOfABox) {
  const PixelLines lines{.factor = 0.05};
  const PixelArea area(Checkerboard(10, 8), lines, lines);
  EXPECT_EQ(area.PixelsIn({0.12, 0.21, 0.13, 0.29}), (PixelRectangle{2, 4, 3, 6}));
  EXPECT_EQ(area.PixelsIn({-1.0, -1.0, 1.0, 1.0}), (PixelRectangle{0, 0, 10, 8}));
  const PixelRectangle beyond = area.PixelsIn({2.0, 2.0, 3.0, 3.0});
  EXPECT_EQ(beyond.x0, beyond.x1);
  // A touch at a line counts.
  EXPECT_EQ(area.PixelsIn({0.1, 0.1, 0.1, 0.1}), (PixelRectangle{1, 1, 3, 3}));
}

TEST(PixelArea, IsEqualByItsPixelsAndLines) {
  const PixelLines lines{.factor = 0.05};
  const PixelArea area(Checkerboard(10, 8), lines, lines);
  EXPECT_EQ(area, PixelArea(Checkerboard(10, 8), lines, lines));
  EXPECT_NE(area, PixelArea(Checkerboard(10, 7), lines, lines));
  EXPECT_NE(area, PixelArea(Checkerboard(10, 8), lines, {.factor = 0.06}));
  EXPECT_NE(area, area.Moved({0.0, 0.0, 0.0, 1.0}));
}

TEST(PixelArea, ChecksItsNumbers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](const PixelLines& x, const Pose& X_MA = {}) {
    return PixelArea(Checkerboard(10, 8), x, {.factor = 0.05}, X_MA).Check().ok();
  };
  EXPECT_TRUE(with({.factor = 0.05}));
  EXPECT_FALSE(with({.factor = 0.0}));
  EXPECT_FALSE(with({.factor = -0.05}));
  EXPECT_FALSE(with({.factor = kNan}));
  EXPECT_FALSE(with({.factor = 1e-7})) << "a pixel too small to be found by arithmetic";
  EXPECT_FALSE(with({.factor = 1e6}));
  EXPECT_FALSE(with({.center = kNan}));
  EXPECT_FALSE(with({.second_center = 1e7}));
  EXPECT_FALSE(with({.second_factor = 1e7}));
  EXPECT_FALSE(with({.shift = 1e7}));
  EXPECT_FALSE(with({.factor = 0.05}, {1e7, 0.0, 0.0, 1.0}));
  EXPECT_FALSE(with({.factor = 0.05}, {0.0, 0.0, 0.0, kNan}));
  EXPECT_FALSE(PixelArea(std::make_shared<const DenseCover>(Bitmap(3, 3)), {}, {}).Check().ok());
}

}  // namespace
}  // namespace troupe
