#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/spatial/grid.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

struct Walked {
  std::vector<std::size_t> cells;
  std::vector<double> distances;
};

Walked Walk(const Grid& grid, const Vec2& origin, const Vec2& direction, double max_distance) {
  Walked walked;
  const auto filled = [&](std::size_t cell) {
    EXPECT_LT(cell, grid.cell_count());
    return true;
  };
  WalkRay(grid, origin, direction, direction.cwiseInverse(), max_distance, filled,
          [&](std::size_t cell, double distance) {
            walked.cells.push_back(cell);
            walked.distances.push_back(distance);
            return true;
          });
  return walked;
}

// Cells: 0 1 2 3 in the lowest row, up to 8 9 10 11.
const Grid kGridOfTwelve({0.0, 0.0, 4.0, 3.0}, 1.0, 100.0);

TEST(WalkRay, WalksStraightRays) {
  EXPECT_EQ(Walk(kGridOfTwelve, {0.5, 0.5}, {1.0, 0.0}, 10.0).cells, (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_EQ(Walk(kGridOfTwelve, {3.5, 0.5}, {-1.0, 0.0}, 10.0).cells, (std::vector<std::size_t>{3, 2, 1, 0}));
  EXPECT_EQ(Walk(kGridOfTwelve, {0.5, 2.5}, {0.0, -1.0}, 10.0).cells, (std::vector<std::size_t>{8, 4, 0}));
  EXPECT_EQ(Walk(kGridOfTwelve, {0.5, 0.5}, {1.0, 0.0}, 10.0).distances, (std::vector<double>{0.0, 0.5, 1.5, 2.5}));
}

TEST(WalkRay, StopsAtTheMaximumDistance) {
  EXPECT_EQ(Walk(kGridOfTwelve, {0.5, 0.5}, {1.0, 0.0}, 1.0).cells, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(Walk(kGridOfTwelve, {0.5, 0.5}, {1.0, 0.0}, 0.0).cells, (std::vector<std::size_t>{0}));
}

TEST(WalkRay, EntersFromOutside) {
  const Walked walked = Walk(kGridOfTwelve, {-2.0, 1.5}, {1.0, 0.0}, 10.0);
  EXPECT_EQ(walked.cells, (std::vector<std::size_t>{4, 5, 6, 7}));
  EXPECT_EQ(walked.distances[0], 2.0);
  EXPECT_TRUE(Walk(kGridOfTwelve, {-2.0, 1.5}, {-1.0, 0.0}, 10.0).cells.empty());
  EXPECT_TRUE(Walk(kGridOfTwelve, {-2.0, 1.5}, {0.0, 1.0}, 10.0).cells.empty());
  EXPECT_TRUE(Walk(kGridOfTwelve, {-2.0, 1.5}, {1.0, 0.0}, 1.0).cells.empty());
}

TEST(WalkRay, StaysInTheGridForAnyRay) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double far : {1e9, 1e300, infinity, nan}) {
    for (const double length : {-1.0, 1.0, 1e300, infinity, nan}) {
      Walk(kGridOfTwelve, {1.5, 1.5}, {-1.0, 0.0}, length);
      Walk(kGridOfTwelve, {far, 1.5}, {-1.0, 0.0}, length);
      Walk(kGridOfTwelve, {far, far}, {-0.8, -0.6}, length);
      Walk(kGridOfTwelve, {-far, 1.0}, {0.6, 0.8}, length);
    }
  }
}

TEST(WalkRay, WalksThroughEveryCellThatTheRayPasses) {
  const Grid grid({-5.0, -5.0, 5.0, 5.0}, 0.37, 10'000.0);
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const Vec2 origin(16.0 * RandomUniform({seed, 0}) - 8.0, 16.0 * RandomUniform({seed, 1}) - 8.0);
    const SinCosResult trig = SinCos(2.0 * kPi * RandomUniform({seed, 2}));
    const Vec2 direction(trig.cos, trig.sin);
    const Walked walked = Walk(grid, origin, direction, 12.0);
    ASSERT_TRUE(std::is_sorted(walked.distances.begin(), walked.distances.end()));
    std::size_t at = 0;
    for (double distance = 0.0; distance < 12.0; distance += 0.01) {
      const Vec2 p = origin + distance * direction;
      if (!grid.bounds().Inflated(-1e-6).Contains(p)) continue;
      while (at < walked.cells.size() && walked.cells[at] != grid.CellOf(p)) ++at;
      ASSERT_LT(at, walked.cells.size()) << "seed " << seed << " at " << distance;
    }
  }
}

// Whether a cell that was visited holds the point, or is within the tolerance of it.
bool IsVisited(const Grid& grid, const Walked& walked, const Vec2& p) {
  const double tolerance = kWalkTolerance * grid.cell_size();
  const CellRange near = grid.CellsOf({p.x() - tolerance, p.y() - tolerance, p.x() + tolerance, p.y() + tolerance});
  for (std::int32_t row = near.min_row; row <= near.max_row; ++row) {
    for (std::int32_t column = near.min_column; column <= near.max_column; ++column) {
      if (std::ranges::find(walked.cells, grid.CellAt(column, row)) != walked.cells.end()) return true;
    }
  }
  return false;
}

void ExpectAllVisited(const Grid& grid, const Vec2& origin, const Vec2& direction, double length) {
  const Walked walked = Walk(grid, origin, direction, length);
  for (double distance = 0.0; distance <= length; distance += 0.05 * grid.cell_size()) {
    const Vec2 p = origin + distance * direction;
    if (!grid.bounds().Inflated(-kWalkTolerance * grid.cell_size()).Contains(p)) continue;
    ASSERT_TRUE(IsVisited(grid, walked, p))
        << origin.transpose() << " along " << direction.transpose() << " at " << distance;
  }
}

TEST(WalkRay, LeavesNoCellOutFromCornerToCorner) {
  // Around each corner of the cells, by as little as a number can differ, and in the directions that lead to another.
  constexpr double kHalfRoot = 0.7071067811865476;
  std::vector<Vec2> directions = {{1.0, 0.0}, {0.0, 1.0}, {kHalfRoot, kHalfRoot}, {0.8, 0.6}, {0.6, 0.8}};
  for (std::size_t i = 0; i < 5; ++i) {
    directions.push_back(-directions[i]);
    directions.emplace_back(directions[i].x(), -directions[i].y());
    directions.emplace_back(-directions[i].x(), directions[i].y());
  }
  for (int x = -3; x <= 7; ++x) {
    for (int y = -3; y <= 6; ++y) {
      for (int way_x = -1; way_x <= 1; ++way_x) {
        for (int way_y = -1; way_y <= 1; ++way_y) {
          const Vec2 origin(std::nextafter(x, x + way_x), std::nextafter(y, y + way_y));
          for (const Vec2& direction : directions) ExpectAllVisited(kGridOfTwelve, origin, direction, 12.0);
        }
      }
    }
  }
}

TEST(WalkRay, FollowsARayThatEntersAtACorner) {
  ExpectAllVisited(kGridOfTwelve, {6.0, 6.0}, {-0.8, -0.6}, 12.0);
  const Grid grid({-10.0, -10.0, 10.0, 10.0}, 20.0 / 12.0, 1000.0);
  ExpectAllVisited(grid, {-9.497034526147136, 22.83039465948047}, {0.7071067811865476, -0.7071067811865476}, 60.0);
}

}  // namespace
}  // namespace troupe
