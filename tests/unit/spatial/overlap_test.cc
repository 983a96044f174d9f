#include "common/spatial/overlap.h"

#include <gtest/gtest.h>

#include "tests/support/test_world.h"

namespace troupe {
namespace {

using test::Box;

TEST(PenetrationDepth, TellsOverlappingTouchingAndApart) {
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

}  // namespace
}  // namespace troupe
