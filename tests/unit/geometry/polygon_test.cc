#include "troupe/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/values.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Polygon kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(Polygon, SignedAreaHasTheSignOfTheTurn) {
  EXPECT_DOUBLE_EQ(SignedArea(kSquare), 1.0);
  EXPECT_DOUBLE_EQ(SignedArea(Polygon(kSquare.rbegin(), kSquare.rend())), -1.0);
  EXPECT_DOUBLE_EQ(SignedArea({}), 0.0);
}

TEST(Polygon, ContainsInsideAndEdge) {
  const Polygon u{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  EXPECT_TRUE(Contains(u, {0.5, 2.0}));
  EXPECT_TRUE(Contains(u, {2.5, 2.0}));
  EXPECT_FALSE(Contains(u, {1.5, 2.0})) << "between the arms";
  EXPECT_TRUE(Contains(u, {1.5, 1.0})) << "on an edge";
  EXPECT_TRUE(Contains(u, {3.0, 3.0})) << "on a vertex";
  EXPECT_FALSE(Contains(u, {-1.0, 0.0})) << "in line with an edge";
  EXPECT_FALSE(Contains(u, {4.0, 3.0}));
}

TEST(Normalized, AcceptsAndCleansOutlines) {
  const struct {
    const char* name;
    Polygon polygon;
    Polygon expected;
  } cases[] = {
      {"already normalized", kSquare, kSquare},
      {"clockwise", {{0, 1}, {1, 1}, {1, 0}, {0, 0}}, kSquare},
      {"first vertex repeated", {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}, {{1, 0}, {1, 1}, {0, 1}, {0, 0}}},
      {"vertex repeated", {{0, 0}, {1, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 1}}, kSquare},
      {"vertices on an edge", {{0, 0}, {0.2, 0}, {0.5, 0}, {1, 0}, {1, 1}, {0, 1}}, kSquare},
      {"collinear up to rounding", {{0, 0}, {0.3, 1e-12}, {1, 0}, {1, 1}, {0, 1}}, kSquare},
      {"a spike outwards", {{0, 0}, {1, 0}, {2, 0}, {1, 0}, {1, 1}, {0, 1}}, kSquare},
      {"a spike beyond its root", {{0, 0}, {1, 0}, {1, 1}, {1, 5}, {1, 1}, {0, 1}}, kSquare},
  };
  for (const auto& c : cases) {
    const Polygon polygon = test::ValueOf(Normalized(c.polygon));
    EXPECT_EQ(polygon.size(), c.expected.size()) << c.name;
    for (const Vec2& vertex : c.expected) {
      EXPECT_NE(std::find(polygon.begin(), polygon.end(), vertex), polygon.end()) << c.name;
    }
    EXPECT_GT(SignedArea(polygon), 0.0) << c.name;
    EXPECT_EQ(test::ValueOf(Normalized(polygon)), polygon) << c.name << ": a normalized polygon stays as it is";
  }
}

TEST(Normalized, AcceptsAnOutlineThatTouchesItself) {
  // A frame cut open: out along the cut and back.
  Polygon keyhole{{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}};
  EXPECT_DOUBLE_EQ(SignedArea(test::ValueOf(Normalized(keyhole))), 8.0);
}

std::string ProblemOf(const Polygon& polygon) {
  const Result<Polygon> normalized = Normalized(polygon);
  return normalized.ok() ? "none" : normalized.error().message;
}

TEST(Normalized, RefusesPolygonsThatAreNoOutlines) {
  const struct {
    const char* name;
    Polygon polygon;
    const char* problem;
  } cases[] = {
      {"nothing", {}, "found 0 vertices, expected at least 3"},
      {"two vertices", {{0, 0}, {1, 1}}, "found 2 vertices, expected at least 3"},
      {"a point", {{1, 1}, {1, 1}, {1, 1}}, "the outline has no area"},
      {"a line", {{0, 0}, {1, 1}, {2, 2}, {3, 3}}, "the outline has no area"},
      {"there and back", {{0, 0}, {1, 0}, {2, 0}, {1, 0}}, "the outline has no area"},
      {"a sliver", {{0, 0}, {1, 1e-10}, {2, 0}}, "the outline has no area"},
      {"a bow tie", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, "edges of the outline cross each other"},
      {"a lopsided bow tie", {{0, 0}, {2, 2}, {2, 0}, {0, 1}}, "edges of the outline cross each other"},
      {"not a number", {{0, 0}, {1, 0}, {kNan, 1}}, "a coordinate is not a finite number"},
      {"infinite", {{0, 0}, {1, 0}, {0, kInfinity}}, "a coordinate is not a finite number"},
      {"huge", {{0, 0}, {1e200, 0}, {0, 1e200}}, "a coordinate is beyond 1000 km"},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(ProblemOf(c.polygon), c.problem) << c.name;
  }
  Polygon pentagram;
  for (int i = 0; i < 5; ++i) {
    const SinCosResult trig = SinCos(2.0 * kPi * 2.0 * i / 5.0);
    pentagram.push_back({trig.cos, trig.sin});
  }
  EXPECT_EQ(ProblemOf(pentagram), "edges of the outline cross each other");
}

TEST(Normalized, RefusesMoreVerticesThanItCanHandle) {
  Polygon circle;
  for (int i = 0; i < 20'000; ++i) {
    const SinCosResult trig = SinCos(2.0 * kPi * i / 20'000.0);
    circle.push_back({trig.cos, trig.sin});
  }
  EXPECT_EQ(ProblemOf(circle), "found 20000 vertices, expected at most 10000");
  circle.resize(10'000);
  EXPECT_TRUE(Normalized(circle).ok());
}

}  // namespace
}  // namespace troupe
