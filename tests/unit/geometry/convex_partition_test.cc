#include "common/geometry/convex_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

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
