// The map of a robot and the paths on it.
#include <gtest/gtest.h>

#include <cmath>
#include <queue>
#include <vector>

#include "robot-agent/navigation/mapped_route.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"

namespace troupe {
namespace {

using Cell = EvidenceGrid::Cell;

Cell CellAt(const EvidenceGrid& grid, double x, double y) {
  return grid[*grid.IndexOf({x, y})];
}

// All cells are seen from within themselves.
void See(EvidenceGrid& grid, std::size_t index, bool occupied) {
  grid.Observe(grid.CenterOf(index), {1.0, 0.0}, 0.0, occupied);
}

TEST(EvidenceGridTest, ARayFreesItsCellsAndOccupiesThatOfItsHit) {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.5);
  EXPECT_EQ(grid.width(), 20u);
  grid.Observe({0.1, 0.1}, {1.0, 0.0}, 2.5, true);
  for (const double x : {0.1, 0.6, 1.1, 1.6, 2.1}) EXPECT_EQ(CellAt(grid, x, 0.1), Cell::kFree) << x;
  EXPECT_EQ(CellAt(grid, 2.6, 0.1), Cell::kOccupied);
  EXPECT_EQ(CellAt(grid, 3.1, 0.1), Cell::kUnknown);
  EXPECT_EQ(CellAt(grid, 0.1, 0.6), Cell::kUnknown);
  grid.Observe({0.1, 0.1}, {0.0, 1.0}, 100.0, false);  // beyond the edge
  EXPECT_EQ(CellAt(grid, 0.1, 4.9), Cell::kFree);
}

TEST(EvidenceGridTest, ABodyThatLeavesIsForgotten) {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.5);
  for (int i = 0; i < 50; ++i) grid.Observe({0.1, 0.1}, {1.0, 0.0}, 2.5, true);
  EXPECT_EQ(CellAt(grid, 2.6, 0.1), Cell::kOccupied);
  int seen_through = 0;
  while (CellAt(grid, 2.6, 0.1) == Cell::kOccupied && seen_through < 100) {
    grid.Observe({0.1, 0.1}, {1.0, 0.0}, 4.0, false);
    ++seen_through;
  }
  EXPECT_GT(seen_through, 2) << "one reading proves nothing";
  EXPECT_LT(seen_through, 20);
}

TEST(EvidenceGridTest, PointsOutsideHaveNoCell) {
  const EvidenceGrid grid({5.0, 5.0}, 2.0, 0.1);
  EXPECT_TRUE(grid.IndexOf({4.01, 5.99}));
  EXPECT_FALSE(grid.IndexOf({3.99, 5.0}));
  EXPECT_FALSE(grid.IndexOf({5.0, 6.01}));
  EXPECT_FALSE(grid.IndexOf({std::nan(""), 5.0}));
  const std::size_t index = *grid.IndexOf({4.55, 5.25});
  EXPECT_NEAR((grid.CenterOf(index) - Vec2(4.55, 5.25)).norm(), 0.0, 1e-9);
}

// A wall across the grid with a gap at its upper end.
EvidenceGrid GridWithAWall() {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.25);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec2 center = grid.CenterOf(i);
    See(grid, i, std::abs(center.x()) < 0.2 && center.y() < 3.0);
  }
  return grid;
}

TEST(PlanPathTest, LeadsThroughTheGapAtADistanceFromTheWall) {
  const EvidenceGrid grid = GridWithAWall();
  const auto path = PlanPath(grid, {-3.0, -3.0}, {3.0, -3.0}, 0.3, 0.6);
  ASSERT_TRUE(path);
  double highest = -10.0;
  Vec2 before(-3.0, -3.0);
  for (const Vec2& point : *path) {
    EXPECT_LT((point - before).norm(), 0.5) << "steps to neighbours";
    before = point;
    highest = std::max(highest, point.y());
    EXPECT_TRUE(point.y() >= 2.0 || std::abs(point.x()) > 0.6) << point.transpose();
  }
  EXPECT_GT(highest, 3.4);
  EXPECT_LE((path->back() - Vec2(3.0, -3.0)).norm(), 0.3);
}

TEST(PlanPathTest, SqueezesThroughWhereThereIsNoOtherWay) {
  const EvidenceGrid grid = GridWithAWall();
  const auto path = PlanPath(grid, {-3.0, 0.0}, {3.0, 0.0}, 0.3, 1.9);
  ASSERT_TRUE(path);
  EXPECT_LE((path->back() - Vec2(3.0, 0.0)).norm(), 0.3);
}

TEST(PlanPathTest, NamesNoWayWhereThereIsNone) {
  EvidenceGrid grid = GridWithAWall();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (std::abs(grid.CenterOf(i).x()) < 0.2) {
      for (int k = 0; k < 20; ++k) See(grid, i, true);
    }
  }
  EXPECT_FALSE(PlanPath(grid, {-3.0, 0.0}, {3.0, 0.0}, 0.3, 0.3));
  EXPECT_FALSE(PlanPath(grid, {-3.0, 0.0}, {30.0, 0.0}, 0.3, 0.3)) << "outside";
  EXPECT_FALSE(PlanToUnknown(grid, {-3.0, 0.0}, 0.3)) << "all is known";
}

TEST(PlanPathTest, FindsTheNearestUnknownPlace) {
  EvidenceGrid grid({0.0, 0.0}, 10.0, 0.25);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec2 center = grid.CenterOf(i);
    if (center.x() < 1.0 && !(center.x() < -2.0 && center.y() < -2.0)) See(grid, i, false);
  }
  const auto path = PlanToUnknown(grid, {0.0, 0.0}, 0.3);
  ASSERT_TRUE(path);
  EXPECT_EQ(CellAt(grid, path->back().x(), path->back().y()), Cell::kUnknown);
  EXPECT_NEAR(path->back().x(), 1.125, 1e-9);
}

// On random grids a way is found exactly if a search over neighbours reaches the goal.
TEST(PlanPathTest, FindsAWayIfAndOnlyIfThereIsOne) {
  int reached = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    EvidenceGrid grid({0.0, 0.0}, 4.0, 0.25);
    const auto width = static_cast<std::int64_t>(grid.width());
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double draw = RandomUniform({seed, i});
      if (draw < 0.9) See(grid, i, draw < 0.45);
    }
    const std::size_t start = 0;
    const std::size_t goal = grid.size() - 1;
    std::vector<bool> seen(grid.size(), false);
    std::queue<std::size_t> open;
    open.push(start);
    seen[start] = true;
    while (!open.empty()) {
      const auto cell = static_cast<std::int64_t>(open.front());
      open.pop();
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dx = -1; dx <= 1; ++dx) {
          const std::int64_t x = cell % width + dx;
          const std::int64_t y = cell / width + dy;
          if (x < 0 || y < 0 || x >= width || y >= width) continue;
          const auto next = static_cast<std::size_t>(y * width + x);
          if (seen[next] || grid[next] == Cell::kOccupied) continue;
          seen[next] = true;
          open.push(next);
        }
      }
    }
    const auto path = PlanPath(grid, grid.CenterOf(start), grid.CenterOf(goal), 0.1, 0.3);
    // The reach is a cell, so that a neighbour of the goal counts.
    const bool expected = seen[goal] || seen[goal - 1] || seen[goal - grid.width()];
    ASSERT_EQ(path.has_value(), expected) << seed;
    if (!path) continue;
    ++reached;
    Vec2 before = grid.CenterOf(start);
    for (const Vec2& point : *path) {
      ASSERT_NE(CellAt(grid, point.x(), point.y()), Cell::kOccupied);
      ASSERT_LT((point - before).norm(), 0.36);
      before = point;
    }
  }
  EXPECT_GT(reached, 20);
  EXPECT_LT(reached, 290);
}

}  // namespace
}  // namespace troupe
