#include "common/picture/rectangle_outline.h"

#include <gtest/gtest.h>

#include "troupe/random.h"

namespace troupe {
namespace {

// Crossings of a ray to the right: odd means inside.
bool InsideOddNumberOfLoops(const std::vector<Polygon>& loops, const Vec2& p) {
  bool inside = false;
  for (const Polygon& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2& a = loop[i];
      const Vec2& b = loop[(i + 1) % loop.size()];
      if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
        inside = !inside;
      }
    }
  }
  return inside;
}

TEST(RectangleOutline, NoRectanglesHaveNoOutline) {
  EXPECT_TRUE(OutlineOf({}).empty());
}

TEST(RectangleOutline, AdjoiningRectanglesBecomeOneLoop) {
  const std::vector<Polygon> loops = OutlineOf({{0, 0, 1, 1}, {1, 0, 2, 1}, {0, 1, 2, 3}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
}

TEST(RectangleOutline, AHoleIsALoopOfItsOwn) {
  const std::vector<Polygon> loops = OutlineOf({{0, 0, 3, 1}, {0, 1, 1, 2}, {2, 1, 3, 2}, {0, 2, 3, 3}});
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_FALSE(InsideOddNumberOfLoops(loops, {1.5, 1.5}));
  EXPECT_TRUE(InsideOddNumberOfLoops(loops, {0.5, 1.5}));
}

TEST(RectangleOutline, RoundingDoesNotSplitASharedEdge) {
  const double third = 1.0 / 3.0;
  const std::vector<Polygon> loops = OutlineOf({{0, 0, third, 1}, {third + 1e-16, 0, 1, 1}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
}

TEST(RectangleOutline, RectanglesWithoutAreaAreLeftOut) {
  EXPECT_TRUE(OutlineOf({{1, 1, 1, 2}}).empty());
}

TEST(RectangleOutline, OutlinesTheAreaOfRandomBitmaps) {
  constexpr int kSize = 12;
  constexpr double kCell = 0.07;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::vector<Rectangle> cells;
    std::vector<bool> filled(kSize * kSize);
    for (int i = 0; i < kSize * kSize; ++i) {
      filled[i] = RandomUniform({seed, std::uint64_t(i)}) < 0.5;
      const double x = i % kSize, y = i / kSize;
      if (filled[i]) cells.push_back({x * kCell, y * kCell, (x + 1) * kCell, (y + 1) * kCell});
    }
    const std::vector<Polygon> loops = OutlineOf(cells);
    for (int i = 0; i < kSize * kSize; ++i) {
      const Vec2 middle((i % kSize + 0.5) * kCell, (i / kSize + 0.5) * kCell);
      ASSERT_EQ(InsideOddNumberOfLoops(loops, middle), filled[i]) << "seed " << seed << " cell " << i;
    }
  }
}

}  // namespace
}  // namespace troupe
