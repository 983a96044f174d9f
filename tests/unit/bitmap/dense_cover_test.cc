#include "troupe/dense_cover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "troupe/random.h"

namespace troupe {
namespace {

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

}  // namespace
}  // namespace troupe
