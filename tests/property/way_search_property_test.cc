// Ways of robots in random worlds: they exist exactly where a flood over the free cells reaches the goal, and keep off
// all that stands there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <queue>
#include <vector>

#include "common/spatial/scene.h"
#include "common/spatial/walk_grid.h"
#include "common/spatial/walk_routes.h"
#include "common/spatial/way_search.h"
#include "tests/support/random_world.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kHalf = 5.0;  // m, of the world's sides
constexpr ZRange kHeights{0.0, 0.5};

struct Problem {
  std::unique_ptr<Scene> scene;
  double radius = 0.0;
  std::vector<ConvexPiece> standing;
  Vec2 from{0.0, 0.0};
  Vec2 to{0.0, 0.0};
};

// Stars all over the place, some of them above the robot.
Problem RandomProblem(std::uint64_t seed, bool with_standing) {
  test::RandomStream random(seed);
  test::TestWorld world;
  const auto point = [&] { return Vec2(random.Uniform(-kHalf, kHalf), random.Uniform(-kHalf, kHalf)); };
  world.AddModel(test::Box(-kHalf, -kHalf, kHalf, -kHalf + 0.1));
  world.AddModel(test::Box(-kHalf, kHalf - 0.1, kHalf, kHalf));
  const std::size_t count = 30 + random.Index(90);
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_above = random.Chance(0.2);
    const Vec2 at = point();
    world.AddModel(test::RandomStar(random, {0.0, 0.0}, 0.1, 0.9), is_above ? ZRange{0.5, 1.0} : ZRange{0.0, 1.0},
                   {at.x(), at.y(), 0.0, random.Angle()});
  }
  world.AddRobot(test::Square(0.3), kHeights, {});
  Problem problem{.scene = std::make_unique<Scene>(std::move(world.world)), .radius = random.Uniform(0.2, 0.5)};
  problem.from = point();
  problem.to = point();
  for (std::size_t i = 0; with_standing && i < 10; ++i) {
    ConvexPiece piece{.vertices = test::RandomConvex(random, 0.1, 0.6), .z = kHeights};
    const Vec2 at = point();
    for (Vec2& vertex : piece.vertices) vertex += at;
    problem.standing.push_back(std::move(piece));
  }
  return problem;
}

std::vector<const ConvexPiece*> Pointers(const std::vector<ConvexPiece>& pieces) {
  std::vector<const ConvexPiece*> pointers;
  for (const ConvexPiece& piece : pieces) pointers.push_back(&piece);
  return pointers;
}

double Distance(const Vec2& point, const std::vector<ConvexPiece>& pieces) {
  double least = 1e9;
  for (const ConvexPiece& piece : pieces) {
    if (!piece.z.Overlaps(kHeights)) continue;
    least = std::min(least, FindNearestPoints(std::span(&point, 1), piece.vertices).distance);
  }
  return least;
}

// The cells that a flood reaches from `start`, over cells whose centre keeps off the pieces.
std::vector<bool> Flood(const WalkGrid& grid, std::size_t start, const std::vector<ConvexPiece>& standing) {
  std::vector<bool> reached(grid.cell_count(), false);
  std::vector<bool> taken(grid.cell_count(), false);
  for (std::size_t cell = 0; cell < taken.size() && !standing.empty(); ++cell) {
    taken[cell] = Distance(grid.CenterOf(cell), standing) < grid.radius();
  }
  std::queue<std::size_t> open;
  reached[start] = true;
  open.push(start);
  while (!open.empty()) {
    const std::size_t cell = open.front();
    open.pop();
    grid.ForEachStep(cell, [&](std::size_t to, std::size_t) {
      if (reached[to] || taken[to]) return;
      reached[to] = true;
      open.push(to);
    });
  }
  return reached;
}

// Sampled each centimetre, from the first point on: before, the robot may be beside the free cells.
double LeastDistance(const Way& way, const std::vector<ConvexPiece>& pieces) {
  double least = 1e9;
  for (std::size_t i = 0; i + 1 < way.points.size(); ++i) {
    const Vec2 leg = way.points[i + 1] - way.points[i];
    const int parts = static_cast<int>(leg.norm() / 0.01) + 1;
    for (int part = 0; part <= parts; ++part) {
      least = std::min(least, Distance(way.points[i] + (static_cast<double>(part) / parts) * leg, pieces));
    }
  }
  return least;
}

TEST(WaySearch, FindsAWayExactlyWhereAFloodReachesTheGoal) {
  int found = 0;
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= 800; ++seed) {
    SCOPED_TRACE(seed);
    const bool with_standing = seed % 2 == 0;
    const Problem problem = RandomProblem(seed, with_standing);
    const auto grid = problem.scene->walk_routes().RobotGrid(*problem.scene, kHeights, problem.radius);
    const std::size_t start = grid->CellOf(problem.from);
    const std::size_t end = grid->CellOf(problem.to);
    // At other places the nearest free cell counts, and cells around the start do: of these the next test says more.
    if (!grid->IsFree(start) || !grid->IsFree(end)) continue;
    if (Distance(problem.from, problem.standing) < problem.radius + 0.5) continue;
    if (Distance(grid->CenterOf(end), problem.standing) < problem.radius) continue;
    const std::vector<bool> reached = Flood(*grid, start, problem.standing);
    const Result<Way> way = FindWay(*grid, problem.from, problem.to, Pointers(problem.standing));
    ASSERT_EQ(way.ok(), reached[end]);
    if (!with_standing) {
      EXPECT_EQ(CheckWays(*grid, problem.from, std::span(&problem.to, 1)).ok(), way.ok());
    }
    if (!way.ok()) {
      ++refused;
      EXPECT_EQ(way.error().message, "no way leads there");
      continue;
    }
    ++found;
    EXPECT_TRUE(way.value().reaches);
    EXPECT_EQ(way.value().points.back(), problem.to);
    // A line is looked at in half cells, by their centres.
    const double slack = grid->cell();
    EXPECT_GT(LeastDistance(way.value(), problem.standing), grid->radius() - slack);
    EXPECT_GT(LeastDistance(way.value(), problem.scene->static_index().kept_pieces()), grid->radius() - slack);
    if (grid->IsClear(problem.from, grid->CenterOf(end)) && problem.standing.empty()) {
      EXPECT_EQ(way.value().points.size(), 1u) << "straight";
    }
  }
  EXPECT_GT(found, 30);
  EXPECT_GT(refused, 0);
}

TEST(WaySearch, AnyProblemHasAWayOrAReason) {
  int beside = 0;
  for (std::uint64_t seed = 1000; seed < 1300; ++seed) {
    SCOPED_TRACE(seed);
    Problem problem = RandomProblem(seed, true);
    if (seed % 5 == 0) problem.to = 3.0 * problem.to;  // perhaps beyond the grid
    const auto grid = problem.scene->walk_routes().RobotGrid(*problem.scene, kHeights, problem.radius);
    const Result<Way> way = FindWay(*grid, problem.from, problem.to, Pointers(problem.standing));
    if (!way.ok()) {
      EXPECT_THAT(way.error().message, testing::AnyOf("no way leads there", "there is no room for the robot",
                                                      "nothing around the robot is free"));
      continue;
    }
    ASSERT_FALSE(way.value().points.empty());
    if (way.value().reaches) {
      EXPECT_EQ(way.value().points.back(), problem.to);
    } else {
      ++beside;
    }
    const Result<Way> again = FindWay(*grid, problem.from, problem.to, Pointers(problem.standing));
    EXPECT_EQ(again.value().points, way.value().points);
  }
  EXPECT_GT(beside, 3) << "something stands at the goal";
}

// A robot at the place that was found: the other one still reaches a goal that it could reach before.
TEST(WaySearch, RoomCutsNothingOff) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    const Problem problem = RandomProblem(seed, false);
    const auto grid = problem.scene->walk_routes().RobotGrid(*problem.scene, kHeights, problem.radius);
    const Vec2 other = problem.from + Vec2(2.0 * problem.radius, 0.0);
    const RoomFor room{.own_radius = problem.radius, .other = other, .of_other = *grid};
    const Result<Way> way = FindRoom(*grid, problem.from, room, {});
    if (!way.ok() || !FindWay(*grid, other, problem.to).ok()) continue;
    const Vec2 place = way.value().points.back();
    if ((problem.to - place).norm() < 3.0 * problem.radius || (other - place).norm() < 2.5 * problem.radius) continue;
    ++found;
    ConvexPiece robot{.z = kHeights};
    for (int i = 0; i < 8; ++i) {
      const SinCosResult corner = SinCos(0.25 * kPi * i);
      robot.vertices.push_back(place + 0.9 * problem.radius * Vec2(corner.cos, corner.sin));
    }
    const ConvexPiece* const standing[] = {&robot};
    // Two percent of the cells may be beyond it, and so the goal in rare cases.
    EXPECT_TRUE(FindWay(*grid, other, problem.to, standing).ok());
  }
  EXPECT_GT(found, 15);
}

TEST(RobotGrids, AreSharedWhileTheyAreInUse) {
  const Problem problem = RandomProblem(1, false);
  const WalkRoutes& routes = problem.scene->walk_routes();
  auto grid = routes.RobotGrid(*problem.scene, kHeights, 0.2);
  EXPECT_EQ(routes.RobotGrid(*problem.scene, kHeights, 0.2), grid);
  EXPECT_NE(routes.RobotGrid(*problem.scene, kHeights, 0.3), grid);
  EXPECT_NE(routes.RobotGrid(*problem.scene, kHeights + 1.0, 0.2), grid);
  EXPECT_LT(routes.RobotGrid(*problem.scene, kHeights, 0.05)->cell(), grid->cell()) << "of small robots";
  const std::weak_ptr<const WalkGrid> old = grid;
  grid.reset();
  EXPECT_TRUE(old.expired());
}

}  // namespace
}  // namespace troupe
