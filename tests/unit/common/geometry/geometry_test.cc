#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/geometry/convex_partition.h"
#include "tests/support/values.h"
#include "troupe/deterministic_math.h"
#include "troupe/polygon.h"
#include "troupe/pose.h"
#include "troupe/random.h"
#include "troupe/z_range.h"

namespace troupe {
namespace {

Pose RandomPose(std::uint64_t seed) {
  const auto draw = [&](std::uint64_t i) { return 2.0 * RandomUniform({seed, i}) - 1.0; };
  return {10.0 * draw(0), 10.0 * draw(1), draw(2), kPi * draw(3)};
}

void ExpectNear(const Pose& a, const Pose& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
  EXPECT_NEAR(WrapAngle(a.heading - b.heading), 0.0, 1e-12);
}

TEST(Pose, ComposesAsGroup) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Pose a = RandomPose(3 * seed);
    const Pose b = RandomPose(3 * seed + 1);
    const Pose c = RandomPose(3 * seed + 2);
    ExpectNear((a * b) * c, a * (b * c));
    ExpectNear(a * Inverse(a), Pose{});
    ExpectNear(Inverse(a) * a, Pose{});
    const Vec2 p(0.3, -0.7);
    EXPECT_LT((Transform2(a * b) * p - Transform2(a) * (Transform2(b) * p)).norm(), 1e-12);
    EXPECT_LT((Transform2(a).InverseTransform(Transform2(a) * p) - p).norm(), 1e-12);
  }
}

TEST(Pose, IdentityChangesNoBit) {
  const Pose pose{0.1, -7.3, 0.5, 3.0};
  EXPECT_EQ(pose * Pose{}, pose);
  EXPECT_EQ(Pose{} * pose, pose);
}

TEST(Integrate, FollowsALineWithoutTurning) {
  const Pose moved = Integrate({.vx = 2.0, .vy = -1.0, .wz = 0.0}, 0.5);
  EXPECT_EQ(moved, (Pose{1.0, -0.5, 0.0, 0.0}));
}

TEST(Integrate, FollowsACircle) {
  // Radius 2 m, a quarter of a turn to the left.
  const Pose moved = Integrate({.vx = kPi, .vy = 0.0, .wz = 0.5 * kPi}, 1.0);
  ExpectNear(moved, {2.0, 2.0, 0.0, 0.5 * kPi});
}

TEST(Integrate, IsContinuousAtTheSwitchToTheSeries) {
  for (double wz : {1e-12, 1e-6, 0.99e-4, 1.01e-4, 1e-3}) {
    const Pose whole = Integrate({.vx = 1.0, .vy = 0.5, .wz = wz}, 1.0);
    const Pose half = Integrate({.vx = 1.0, .vy = 0.5, .wz = wz}, 0.5);
    ExpectNear(whole, half * half);
  }
}

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

double TotalArea(const std::vector<Polygon>& pieces) {
  return std::accumulate(pieces.begin(), pieces.end(), 0.0,
                         [](double sum, const Polygon& piece) { return sum + SignedArea(piece); });
}

bool IsConvex(const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[(i + 1) % polygon.size()];
    const Vec2& c = polygon[(i + 2) % polygon.size()];
    if (Cross(b - a, c - b) < -1e-12) return false;
  }
  return SignedArea(polygon) > 0.0;
}

// Convex pieces made of the polygon's vertices, that lie in the polygon and have its area, cover it without overlap.
void ExpectPartition(const Polygon& polygon, const std::vector<Polygon>& pieces, const std::string& name) {
  EXPECT_NEAR(TotalArea(pieces), SignedArea(polygon), 1e-9 * SignedArea(polygon) + 1e-15) << name;
  for (const Polygon& piece : pieces) {
    EXPECT_TRUE(IsConvex(piece)) << name;
    Vec2 center = Vec2::Zero();
    for (const Vec2& vertex : piece) {
      EXPECT_NE(std::find(polygon.begin(), polygon.end(), vertex), polygon.end()) << name;
      center += vertex / static_cast<double>(piece.size());
    }
    EXPECT_TRUE(Contains(polygon, center)) << name;
  }
}

int ReflexVertices(const Polygon& polygon) {
  int count = 0;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& b = polygon[(i + 1) % n];
    count += Cross(b - polygon[i], polygon[(i + 2) % n] - b) < 0.0;
  }
  return count;
}

TEST(ConvexPartition, LeavesConvexPolygonsWhole) {
  Polygon circle;
  for (int i = 0; i < 40; ++i) {
    const SinCosResult trig = SinCos(2.0 * kPi * i / 40.0);
    circle.push_back({trig.cos, trig.sin});
  }
  const auto pieces = ConvexPartition(circle);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_EQ(pieces[0], circle);
}

TEST(ConvexPartition, CutsKnownShapes) {
  const struct {
    const char* name;
    Polygon polygon;
    std::size_t max_pieces;
  } cases[] = {
      {"L", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 2},
      {"U", {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}, 3},
      {"plus", {{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {2, 2}, {2, 3}, {1, 3}, {1, 2}, {0, 2}, {0, 1}, {1, 1}}, 5},
      {"arrow head", {{0, 0}, {2, 1}, {0, 2}, {0.5, 1}}, 2},
  };
  for (const auto& c : cases) {
    const auto pieces = ConvexPartition(c.polygon);
    ExpectPartition(c.polygon, pieces, c.name);
    EXPECT_LE(pieces.size(), c.max_pieces) << c.name;
  }
}

TEST(ConvexPartition, CutsAFrameThatIsCutOpen) {
  Polygon keyhole{{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}};
  const Polygon outline = Normalized(keyhole).value();
  const auto pieces = ConvexPartition(outline);
  ExpectPartition(outline, pieces, "keyhole");
  for (const Polygon& piece : pieces) EXPECT_FALSE(Contains(piece, {1.5, 1.5}));
}

TEST(ConvexPartition, CutsRandomStars) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    Polygon polygon;
    const std::uint64_t count = 4 + RandomBits({seed}) % 40;
    for (std::uint64_t i = 0; i < count; ++i) {
      const SinCosResult trig = SinCos(2.0 * kPi * static_cast<double>(i) / static_cast<double>(count));
      polygon.push_back((0.05 + RandomUniform({seed, i})) * Vec2(trig.cos, trig.sin));
    }
    const Result<Polygon> outline = Normalized(polygon);
    if (!outline.ok()) continue;
    const auto pieces = ConvexPartition(outline.value());
    ExpectPartition(outline.value(), pieces, "seed " + std::to_string(seed));
    // The fewest possible are more than half of the reflex vertices.
    EXPECT_LE(pieces.size(), 2u * static_cast<std::size_t>(ReflexVertices(outline.value())) + 1u);
  }
}

TEST(ConvexPartition, CutsRandomTours) {
  // Random points joined in any order, then uncrossed: winding, far from star-shaped outlines.
  int tours = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Polygon polygon;
    const std::uint64_t count = 5 + RandomBits({seed}) % 25;
    const bool lattice = seed % 3 == 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      Vec2 p(RandomUniform({seed, i, 0}), RandomUniform({seed, i, 1}));
      if (lattice) p = (p * 6.0).array().floor();
      polygon.push_back(p);
    }
    const auto at = [&](std::size_t i) -> Vec2& { return polygon[i % polygon.size()]; };
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i + 2; j < count; ++j) {
          const double before = (at(i) - at(i + 1)).norm() + (at(j) - at(j + 1)).norm();
          const double after = (at(i) - at(j)).norm() + (at(i + 1) - at(j + 1)).norm();
          if (after > before - 1e-9) continue;
          std::reverse(polygon.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                       polygon.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          changed = true;
        }
      }
    }
    const Result<Polygon> outline = Normalized(polygon);
    if (!outline.ok()) continue;
    ++tours;
    ExpectPartition(outline.value(), ConvexPartition(outline.value()), "seed " + std::to_string(seed));
  }
  EXPECT_GT(tours, 300);
}

TEST(ConvexPartition, CutsALongComb) {
  Polygon comb;
  constexpr int kTeeth = 1000;
  for (int i = 0; i < kTeeth; ++i) {
    comb.push_back({i * 1.0, 0.0});
    comb.push_back({i + 0.5, -1.0});
  }
  comb.push_back({kTeeth * 1.0, 0.0});
  comb.push_back({kTeeth * 1.0, 1.0});
  comb.push_back({0.0, 1.0});
  const Polygon outline = Normalized(comb).value();
  ExpectPartition(outline, ConvexPartition(outline), "comb");
}

}  // namespace
}  // namespace troupe
