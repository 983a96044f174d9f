#include "common/spatial/ray_cast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/spatial/grid_walk.h"
#include "common/spatial/ray_shape.h"
#include "common/spatial/scene.h"
#include "tests/support/test_world.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

using test::Box;
using test::Square;
using test::TestWorld;

class RayCastTest : public testing::Test {
 protected:
  std::optional<RayHit> Cast(const Vec2& origin, const Vec2& direction, double z = 0.5, double max_distance = 10.0,
                             std::optional<RobotId> caster = {}) const {
    const Scene scene(test_.world);
    BodyIndex robots(scene);
    robots.Assign(PlacedState(scene.world()));
    return CastRay(scene, robots, {origin, direction, z, max_distance}, caster);
  }

  TestWorld test_;
};

TEST_F(RayCastTest, HitsTheNearestFace) {
  test_.AddModel(Box(5, -1, 6, 1));
  const ModelId near = test_.AddModel(Box(2, -1, 3, 1));
  const auto hit = Cast({0, 0}, {1, 0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->distance, 2.0);
  EXPECT_EQ(hit->model, near);
  EXPECT_FALSE(Cast({0, 0}, {-1, 0}));
  EXPECT_EQ(Cast({4, 0}, {-1, 0})->distance, 1.0);
  EXPECT_EQ(Cast({2.5, 4}, {0, -1})->distance, 3.0);
}

TEST_F(RayCastTest, ReachesExactlyToItsLength) {
  test_.AddModel(Box(2, -1, 3, 1));
  EXPECT_TRUE(Cast({0, 0}, {1, 0}, 0.5, 2.0));
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.5, 1.999999));
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.5, 0.0));
}

TEST_F(RayCastTest, SeesOnlyItsOwnHeight) {
  test_.AddModel(Box(2, -1, 3, 1), {0.4, 0.6});
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.39));
  EXPECT_TRUE(Cast({0, 0}, {1, 0}, 0.4));
  EXPECT_TRUE(Cast({0, 0}, {1, 0}, 0.5));
  EXPECT_FALSE(Cast({0, 0}, {1, 0}, 0.6)) << "the top belongs to the space above";
}

TEST_F(RayCastTest, LooksThroughTransparentModels) {
  test_.model(test_.AddModel(Box(2, -1, 3, 1))).ranger_return = -1.0;
  EXPECT_FALSE(Cast({0, 0}, {1, 0}));
  test_.model(ModelId(0)).ranger_return = 0.0;
  test_.model(ModelId(0)).obstacle_return = false;
  EXPECT_TRUE(Cast({0, 0}, {1, 0})) << "dark and no obstacle, but seen";
}

TEST_F(RayCastTest, ReadsZeroInsideABlock) {
  const ModelId block = test_.AddModel(Box(-1, -1, 1, 1));
  for (const Vec2& direction : {Vec2(1, 0), Vec2(0, -1), Vec2(0.6, 0.8)}) {
    const auto hit = Cast({0.2, 0.3}, direction);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->distance, 0.0);
    EXPECT_EQ(hit->model, block);
  }
}

TEST_F(RayCastTest, LeavesAFaceThatItStartsOn) {
  test_.AddModel(Box(-1, -1, 0, 1));
  EXPECT_FALSE(Cast({0, 0}, {1, 0})) << "away from the face";
  EXPECT_EQ(Cast({0, 0}, {-1, 0})->distance, 0.0) << "into it";
}

TEST_F(RayCastTest, NamesTheLowestModelOfTwoAtTheSameDistance) {
  const ModelId first = test_.AddModel(Box(2, -1, 3, 1));
  test_.AddModel(Box(2, -1, 3, 1));
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, first);
  const RobotId robot = test_.AddRobot(Box(2, -1, 3, 1), {0.0, 1.0}, {});
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, first);
  test_.model(first).ranger_return = -1.0;
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, ModelId(1));
  test_.model(ModelId(1)).ranger_return = -1.0;
  EXPECT_EQ(Cast({0, 0}, {1, 0})->model, test_.world.robot(robot).root);
}

TEST_F(RayCastTest, SeesOtherRobotsButNotItsOwn) {
  const RobotId self = test_.AddRobot(Square(1.0), {0.0, 1.0}, {});
  test_.AddModel(Square(0.2), {0.0, 1.0}, {0.6, 0.0, 0.0, 0.0}, test_.world.robot(self).root);
  const RobotId other = test_.AddRobot(Square(1.0), {0.0, 1.0}, {4.0, 0.0, 0.0, 0.0});
  const ModelId mast = test_.AddModel(Square(0.2), {1.0, 1.0}, {0.0, 0.0, 0.0, 0.0}, test_.world.robot(other).root);
  const auto hit = Cast({0, 0}, {1, 0}, 0.5, 10.0, self);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->distance, 3.5);
  EXPECT_EQ(hit->model, test_.world.robot(other).root);
  EXPECT_EQ(Cast({0, 0}, {1, 0}, 0.5, 10.0)->distance, 0.0) << "without a caster everything counts";
  test_.world.shapes[test_.model(mast).shape.index()].blocks[0].z = {1.0, 2.0};
  EXPECT_EQ(Cast({0, 0}, {1, 0}, 1.5, 10.0, self)->model, mast);
}

TEST_F(RayCastTest, RunsAlongAWall) {
  const ModelId wall = test_.AddModel(Box(2, 0, 3, 1));
  const auto along = Cast({0, 0}, {1, 0});
  ASSERT_TRUE(along) << "the edge belongs to the wall";
  EXPECT_EQ(along->distance, 2.0);
  EXPECT_EQ(along->model, wall);
  EXPECT_FALSE(Cast({0, -1e-9}, {1, 0}));
}

TEST(CastRays, FillsOneEntryForEachRay) {
  TestWorld test;
  test.AddModel(Box(2, -5, 3, 5));
  const Scene scene(test.world);
  BodyIndex robots(scene);
  robots.Assign(PlacedState(scene.world()));
  std::vector<std::optional<RayHit>> hits(7);
  const double kHalf = std::sqrt(0.5);
  std::vector<Ray> rays;
  for (const Vec2& direction : {Vec2(1, 0), Vec2(-1, 0), Vec2(kHalf, -kHalf)}) {
    rays.push_back({{0, 0}, direction, 0.5, 10.0});
  }
  CastRays(scene, robots, rays, std::nullopt, hits);
  ASSERT_EQ(hits.size(), 3u);
  EXPECT_NEAR(hits[0]->distance, 2.0, 1e-15);
  EXPECT_FALSE(hits[1]);
  EXPECT_NEAR(hits[2]->distance, 2.0 * 1.4142135623730951, 1e-14);
  CastRays(scene, robots, {}, std::nullopt, hits);
  EXPECT_TRUE(hits.empty());
}

using Kind = RayShape::Passage::Kind;

// The shape of a body of one piece with these vertices.
RayShape ShapeOf(const std::vector<Vec2>& vertices) {
  Body body;
  body.pieces.push_back({vertices, {0.0, 1.0}, {}, true, 1.0});
  body.piece_links.push_back(0);
  body.radius = 1.0;
  body.z = {0.0, 1.0};
  RayShapes shapes;
  return shapes[shapes.Add(body)];
}

std::vector<Vec2> RegularPolygon(int count, double radius) {
  std::vector<Vec2> vertices;
  for (int i = 0; i < count; ++i) {
    const SinCosResult trig = SinCos(2.0 * kPi * i / count);
    vertices.emplace_back(radius * trig.cos, radius * trig.sin);
  }
  return vertices;
}

RayShape::Passage Pass(const RayShape& shape, const Vec2& point, const Vec2& direction) {
  return shape.Pass(shape.pieces[0], direction, Cross(direction, point));
}

TEST(RayShape, FindsTheEdgesThatALinePasses) {
  const std::vector<Vec2> square = {{0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}};
  RayShape::Passage passage = Pass(ShapeOf(square), {0.0, 0.1}, {1.0, 0.0});
  EXPECT_EQ(passage.kind, Kind::kThrough);
  EXPECT_EQ(passage.enter, 2u);
  EXPECT_EQ(passage.leave, 0u);
  passage = Pass(ShapeOf(square), {0.1, 0.0}, {0.0, -1.0});
  EXPECT_EQ(passage.enter, 1u);
  EXPECT_EQ(passage.leave, 3u) << "from the last vertex to the first";
}

TEST(RayShape, ReportsALineTooNearToAVertex) {
  const RayShape shape = ShapeOf({{0.5, 0.0}, {0.0, 0.5}, {-0.5, 0.0}, {0.0, -0.5}});
  EXPECT_EQ(Pass(shape, {0.0, 0.5}, {1.0, 0.0}).kind, Kind::kUnclear);
  EXPECT_EQ(Pass(shape, {0.0, 0.0}, {1.0, 0.0}).kind, Kind::kUnclear);
  EXPECT_EQ(Pass(shape, {0.0, 0.501}, {1.0, 0.0}).kind, Kind::kApart);
  EXPECT_EQ(Pass(shape, {0.0, 0.499}, {1.0, 0.0}).kind, Kind::kThrough);
  EXPECT_EQ(Pass(ShapeOf(RegularPolygon(100, 1.0)), {0.0, 0.0}, {0.6, 0.8}).kind, Kind::kUnclear) << "too many";
}

TEST(RayShape, IsRightAboutAnyLine) {
  int through = 0;
  for (int count = 3; count <= 32; ++count) {
    const std::vector<Vec2> vertices = RegularPolygon(count, 0.7);
    const RayShape shape = ShapeOf(vertices);
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      const auto random = [&](std::uint64_t which) {
        return RandomUniform({static_cast<std::uint64_t>(count), seed, which});
      };
      const Vec2 point(2.0 * random(0) - 1.0, 2.0 * random(1) - 1.0);
      const SinCosResult trig = SinCos(2.0 * kPi * random(2));
      const Vec2 direction(trig.cos, trig.sin);
      const auto is_left = [&](std::size_t i) { return Cross(direction, vertices[i % vertices.size()] - point) > 0.0; };
      std::size_t left = 0;
      for (std::size_t i = 0; i < vertices.size(); ++i) left += is_left(i) ? 1 : 0;
      const RayShape::Passage passage = Pass(shape, point, direction);
      const bool apart = left == 0 || left == vertices.size();
      ASSERT_TRUE(passage.kind != Kind::kApart || apart);
      if (passage.kind != Kind::kThrough) continue;
      ++through;
      ASSERT_TRUE(is_left(passage.enter) && !is_left(passage.enter + 1));
      ASSERT_TRUE(!is_left(passage.leave) && is_left(passage.leave + 1));
    }
  }
  EXPECT_GT(through, 3000);
}

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
