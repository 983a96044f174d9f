#include <gtest/gtest.h>

#include <cmath>

#include "common/spatial/convex_piece.h"
#include "tests/support/test_world.h"

namespace troupe {
namespace {

using test::Box;

TEST(PenetrationDepth, DistinguishesOverlappingTouchingAndApart) {
  const Polygon unit = Box(0, 0, 1, 1);
  const struct {
    const char* name;
    Polygon other;
    double depth;
  } cases[] = {
      {"a little from the side", Box(0.9, 0.2, 2, 0.8), 0.1},
      {"a little at the corner", Box(0.9, 0.8, 2, 2), 0.1},
      {"the same", unit, 1.0},
      {"contained", Box(0.4, 0.4, 0.6, 0.6), 0.6},
      {"containing", Box(-1, -1, 2, 2), 2.0},
      {"crossing", Box(-1, 0.4, 2, 0.6), 0.6},
      {"edges touch", Box(1, 0, 2, 1), 0.0},
      {"corners touch", Box(1, 1, 2, 2), 0.0},
      {"apart", Box(1.5, 0, 2, 1), -0.5},
      {"a corner in an edge", {{0.9, 0.5}, {1.5, 0.0}, {1.5, 1.0}}, 0.1},
  };
  for (const auto& c : cases) {
    EXPECT_NEAR(PenetrationDepth(unit, c.other), c.depth, 1e-15) << c.name;
    EXPECT_NEAR(PenetrationDepth(c.other, unit), c.depth, 1e-15) << c.name << ", the other way round";
  }
}

TEST(PenetrationDepth, BoundsTheDistanceFromBelow) {
  const Polygon unit = Box(0, 0, 1, 1);
  const double depth = PenetrationDepth(unit, Box(2, 2, 3, 3));  // corner to corner: sqrt(2) apart
  EXPECT_LT(depth, 0.0);
  EXPECT_LE(-depth, 1.4142135623730951);
}

TEST(OverlapBy, IsTrueWhereTheDepthIsMore) {
  const Polygon unit = Box(0, 0, 1, 1);
  const Polygon others[] = {Box(0.9, 0.2, 2, 0.8), unit, Box(1, 0, 2, 1), Box(1.5, 0, 2, 1), Box(2, 2, 3, 3)};
  for (const Polygon& other : others) {
    const double depth = PenetrationDepth(unit, other);
    EXPECT_FALSE(OverlapBy(unit, other, depth)) << depth;
    EXPECT_TRUE(OverlapBy(unit, other, std::nextafter(depth, -2.0))) << depth;
    EXPECT_FALSE(OverlapBy(unit, other, depth + 0.01)) << depth;
    EXPECT_TRUE(OverlapBy(unit, other, depth - 0.01)) << depth;
  }
}

TEST(StayApart, IsTrueIfANormalShowsAGapDuringTheWholeMotion) {
  const Polygon unit = Box(0, 0, 1, 1);
  const struct {
    const char* name;
    Polygon later;
    Polygon other;
    double margin;
    bool apart;
  } cases[] = {
      {"past a wall", Box(0, 5, 1, 6), Box(1.2, 0, 2, 9), 0.1, true},
      {"past a wall, with a margin that reaches it", Box(0, 5, 1, 6), Box(1.2, 0, 2, 9), 0.21, false},
      {"up to a wall", Box(1, 0, 2, 1), Box(2.2, 0, 3, 1), 0.1, true},
      {"into a wall", Box(1, 0, 2, 1), Box(1.9, 0, 3, 1), 0.0, false},
      {"through a wall, to beyond it", Box(5, 0, 6, 1), Box(2.9, 0, 3, 1), 0.0, false},
      {"away from a wall", Box(-1, 0, 0, 1), Box(1.2, 0, 3, 1), 0.1, true},
      {"from overlap to none", Box(-5, 0, -4, 1), Box(0.9, 0, 3, 1), 0.0, false},
      {"past a corner, shown by its slanting edge", Box(2, 0, 3, 1), {{1.5, 1.2}, {3.5, 3.2}, {1.5, 3.2}}, 0.1, true},
  };
  for (const auto& c : cases) EXPECT_EQ(StayApart(unit, c.later, c.other, c.margin), c.apart) << c.name;
}

}  // namespace
}  // namespace troupe
