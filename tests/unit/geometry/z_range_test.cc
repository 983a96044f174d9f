#include "troupe/z_range.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

TEST(ZRange, OverlapsOnlyWhereALengthIsShared) {
  const ZRange table{0.5, 1.0};
  const struct {
    const char* name;
    ZRange other;
    bool overlaps;
  } cases[] = {
      {"below", {0.0, 0.4}, false},
      {"above", {1.1, 2.0}, false},
      {"touching below", {0.0, 0.5}, false},
      {"touching above", {1.0, 1.5}, false},
      {"touching below up to rounding", {0.0, 0.1 + 0.2 + 0.2 + 1e-16}, false},
      {"reaching in from below", {0.0, 0.6}, true},
      {"reaching in from above", {0.9, 1.5}, true},
      {"containing", {0.0, 2.0}, true},
      {"contained", {0.6, 0.9}, true},
      {"contained at the bottom", {0.5, 0.6}, true},
      {"contained at the top", {0.9, 1.0}, true},
      {"equal", {0.5, 1.0}, true},
      {"without height, inside", {0.7, 0.7}, false},
      {"without height, at the edge", {0.5, 0.5}, false},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(table.Overlaps(c.other), c.overlaps) << c.name;
    EXPECT_EQ(c.other.Overlaps(table), c.overlaps) << c.name << ", the other way round";
  }
}

TEST(ZRange, ContainsItsBottomButNotItsTop) {
  const ZRange range{0.5, 1.0};
  EXPECT_TRUE(range.Contains(0.5));
  EXPECT_TRUE(range.Contains(0.75));
  EXPECT_FALSE(range.Contains(1.0));
  EXPECT_FALSE(range.Contains(0.49));
}

}  // namespace
}  // namespace troupe
