// Walkers that avoid each other and walls.
#include "common/crowd/orca.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace troupe {
namespace {

constexpr double kTick = 0.25;  // s

struct Goer {
  Walker walker;
  Vec2 goal;
  double length = 0.0;  // m, of its path
};

// The nearest ten.
std::vector<WalkerNeighbor> NeighborsOf(const std::vector<Goer>& goers, std::size_t i, double reach) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t k = 0; k < goers.size(); ++k) {
    const double distance = (goers[k].walker.position - goers[i].walker.position).norm();
    if (k != i && distance < reach) near.emplace_back(distance, k);
  }
  std::sort(near.begin(), near.end());
  near.resize(std::min<std::size_t>(near.size(), 10));
  std::vector<WalkerNeighbor> neighbors;
  for (const auto& [distance, k] : near) {
    const Walker& other = goers[k].walker;
    neighbors.push_back({other.position, other.velocity, other.radius, 0.5});
  }
  return neighbors;
}

void Advance(std::vector<Goer>& goers, const std::vector<Vec2>& velocities) {
  for (std::size_t i = 0; i < goers.size(); ++i) {
    goers[i].walker.velocity = velocities[i];
    goers[i].walker.position += kTick * velocities[i];
    goers[i].length += kTick * velocities[i].norm();
  }
}

// All walk to their goals for a tick, each as the others were before it.
void Walk(std::vector<Goer>& goers, const std::vector<WallSegment>& walls, double horizon, double reach) {
  Orca orca({.walkers = horizon, .walls = 2.0, .tick = kTick});
  std::vector<Vec2> velocities;
  for (std::size_t i = 0; i < goers.size(); ++i) {
    Walker& walker = goers[i].walker;
    const Vec2 to_goal = goers[i].goal - walker.position;
    walker.preferred = to_goal.norm() > 1.0 ? Vec2(to_goal.normalized()) : to_goal;
    velocities.push_back(orca.Velocity(walker, NeighborsOf(goers, i, reach), walls));
  }
  Advance(goers, velocities);
}

double LeastGap(const std::vector<Goer>& goers) {
  double least = 1e9;
  for (std::size_t i = 0; i < goers.size(); ++i) {
    for (std::size_t k = i + 1; k < goers.size(); ++k) {
      const Walker& a = goers[i].walker;
      const Walker& b = goers[k].walker;
      least = std::min(least, (a.position - b.position).norm() - a.radius - b.radius);
    }
  }
  return least;
}

Goer GoerTo(const Vec2& from, const Vec2& goal, double radius, double max_speed) {
  Goer goer;
  goer.walker.position = from;
  goer.walker.radius = radius;
  goer.walker.max_speed = max_speed;
  goer.goal = goal;
  return goer;
}

TEST(Orca, AloneAWalkerHasItsPreferredVelocityUpToItsSpeed) {
  Orca orca({});
  Walker walker{.preferred = {0.3, -0.4}, .radius = 0.3, .max_speed = 1.0};
  EXPECT_EQ(orca.Velocity(walker, {}, {}), Vec2(0.3, -0.4));
  walker.preferred = {3.0, -4.0};
  EXPECT_NEAR((orca.Velocity(walker, {}, {}) - Vec2(0.6, -0.8)).norm(), 0.0, 1e-12);
}

TEST(Orca, AWalkerWithoutAvoidanceIsAvoidedWholly) {
  Orca orca({.walkers = 2.0});
  const Walker walker{.velocity = {1.0, 0.0}, .preferred = {1.0, 0.0}, .radius = 0.3, .max_speed = 2.0};
  const WalkerNeighbor ahead{{3.0, 0.1}, {-1.0, 0.0}, 0.3, 1.0};
  const Vec2 velocity = orca.Velocity(walker, {{ahead}}, {});
  double least = 1e9;  // distance until the horizon
  for (double t = 0.0; t <= 2.0; t += 0.01) {
    least = std::min(least, (ahead.position + t * ahead.velocity - t * velocity).norm());
  }
  EXPECT_GE(least, 0.6 - 1e-9);
  EXPECT_LE(least, 0.6 + 1e-3);  // and no more than needed
}

struct CircleRun {
  int ticks = 0;        // until all have arrived
  double least = 1e9;   // m, the smallest gap; negative: an overlap
  double length = 0.0;  // of paths, by that of straight ones
};

// The scene of the paper: walkers on a circle of 80 m whose goals are opposite; with the radius, horizon and speeds of
// the example of the reference implementation (RVO2).
CircleRun RunCircle(int count) {
  constexpr double kRadius = 80.0;
  std::vector<Goer> goers;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const Vec2 start = kRadius * Vec2(std::cos(angle), std::sin(angle));
    goers.push_back(GoerTo(start, -start, 1.5, 2.0));
  }
  const auto has_arrived = [](const Goer& goer) {
    return (goer.goal - goer.walker.position).norm() <= goer.walker.radius;
  };
  CircleRun run;
  for (; run.ticks < 3000 && !std::all_of(goers.begin(), goers.end(), has_arrived); ++run.ticks) {
    Walk(goers, {}, 10.0, 15.0);
    run.least = std::min(run.least, LeastGap(goers));
  }
  for (const Goer& goer : goers) run.length += goer.length / (2.0 * kRadius * count);
  return run;
}

TEST(Orca, WalkersOnACircleDoAsThoseOfTheReferenceImplementation) {
  // So few are as a mirror of each other until they stand in the middle. RVO2: no overlap, paths of 0.3805.
  const CircleRun few = RunCircle(40);
  EXPECT_GE(few.least, -1e-5);
  EXPECT_NEAR(few.length, 0.3805, 1e-3);
  // So many are a jam in the middle, where no velocity avoids all. RVO2: 1207 ticks, -0.437 m, 1.108.
  const CircleRun many = RunCircle(100);
  EXPECT_LT(many.ticks, 2000);
  EXPECT_GE(many.least, -0.5);
  EXPECT_LE(many.length, 1.15);
}

// The sides that a walker sees of squares, by distance, within its reach.
std::vector<WallSegment> SidesNear(const std::vector<std::vector<Vec2>>& squares, const Vec2& p, double reach) {
  std::vector<std::pair<double, WallSegment>> near;
  for (const std::vector<Vec2>& square : squares) {
    for (std::size_t i = 0; i < square.size(); ++i) {
      const WallSegment side{square[i], square[(i + 1) % square.size()]};
      const Vec2 along = side.b - side.a;
      if (Cross(along, p - side.a) >= 0.0) continue;
      const double s = std::clamp((p - side.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const double distance = (side.a + s * along - p).norm();
      if (distance < reach) near.emplace_back(distance, side);
    }
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<WallSegment> sides;
  for (const auto& each : near) sides.push_back(each.second);
  return sides;
}

TEST(Orca, WalkersAmongBlocksDoAsThoseOfTheReferenceImplementation) {
  // The scene "Blocks" of RVO2: four groups of 25 that change corners, through the gaps of 20 m between four blocks.
  std::vector<Goer> goers;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      for (const Vec2& corner : {Vec2(1.0, 1.0), Vec2(-1.0, 1.0), Vec2(1.0, -1.0), Vec2(-1.0, -1.0)}) {
        const Vec2 start(corner.x() * (55.0 + 10.0 * i), corner.y() * (55.0 + 10.0 * j));
        goers.push_back(GoerTo(start, -75.0 * corner, 2.0, 2.0));
      }
    }
  }
  std::vector<std::vector<Vec2>> blocks;
  for (const double x : {-40.0, 10.0}) {
    for (const double y : {-40.0, 10.0}) {
      blocks.push_back({{x, y}, {x + 30.0, y}, {x + 30.0, y + 30.0}, {x, y + 30.0}});
    }
  }
  Orca orca({.walkers = 5.0, .walls = 5.0, .tick = kTick});
  const auto is_near = [](const Goer& goer) { return (goer.goal - goer.walker.position).norm() <= 20.0; };
  CircleRun run;
  for (; run.ticks < 6000 && !std::all_of(goers.begin(), goers.end(), is_near); ++run.ticks) {
    std::vector<Vec2> velocities;
    for (std::size_t i = 0; i < goers.size(); ++i) {
      Walker& walker = goers[i].walker;
      const Vec2 to_goal = goers[i].goal - walker.position;
      const double angle = 0.7 * static_cast<double>(run.ticks) + 2.4 * static_cast<double>(i);  // against symmetry
      walker.preferred =
          (to_goal.norm() > 1.0 ? Vec2(to_goal.normalized()) : to_goal) + 5e-5 * Vec2(std::cos(angle), std::sin(angle));
      velocities.push_back(
          orca.Velocity(walker, NeighborsOf(goers, i, 15.0), SidesNear(blocks, walker.position, 12.0)));
    }
    Advance(goers, velocities);
    if (run.ticks % 8 == 0) run.least = std::min(run.least, LeastGap(goers));
  }
  for (const Goer& goer : goers) run.length += goer.length / static_cast<double>(goers.size());
  // They jam between the blocks for a while. RVO2: 4422 ticks, -0.123 m, 354.9 m.
  EXPECT_LT(run.ticks, 5500);
  EXPECT_GE(run.least, -0.3);
  EXPECT_GT(run.length, 200.0);
  EXPECT_LT(run.length, 390.0);
}

TEST(Orca, AWallStopsAWalkerAndIsFollowed) {
  const std::vector<WallSegment> walls{{{2.0, -3.0}, {2.0, 3.0}}};
  std::vector<Goer> goers{GoerTo({0.0, 0.0}, {6.0, 0.0}, 0.3, 1.5), GoerTo({0.0, 2.0}, {6.0, 5.0}, 0.3, 1.5)};
  double farthest = 0.0;
  for (int i = 0; i < 200; ++i) {
    Walk(goers, walls, 2.0, 5.0);
    for (const Goer& goer : goers) {
      const Vec2& p = goer.walker.position;
      const Vec2 nearest(2.0, std::clamp(p.y(), -3.0, 3.0));
      EXPECT_GE((p - nearest).norm(), 0.3 - 1e-6) << "tick " << i;
    }
    farthest = std::max(farthest, goers[0].walker.position.x());
  }
  EXPECT_NEAR(farthest, 1.7, 0.05);                                          // straight ahead there is no way
  EXPECT_NEAR((goers[1].walker.position - goers[1].goal).norm(), 0.0, 0.1);  // around the end
}

TEST(Orca, WalkersThatOverlapMoveApart) {
  std::vector<Goer> goers{GoerTo({0.0, 0.0}, {0.0, 0.0}, 0.5, 1.0), GoerTo({0.4, 0.0}, {0.4, 0.0}, 0.5, 1.0)};
  for (int i = 0; i < 40; ++i) Walk(goers, {}, 2.0, 5.0);
  EXPECT_GE(LeastGap(goers), -0.02);
}

TEST(Orca, EqualInputsGiveEqualBits) {
  const auto run = [] {
    std::vector<Goer> goers;
    for (int i = 0; i < 12; ++i) goers.push_back(GoerTo({1.0 * i, 0.1 * (i % 3)}, {11.0 - i, 0.0}, 0.3, 1.2));
    for (int i = 0; i < 60; ++i) Walk(goers, {{{0.0, 1.0}, {11.0, 1.0}}}, 3.0, 4.0);
    std::vector<Vec2> positions;
    for (const Goer& goer : goers) positions.push_back(goer.walker.position);
    return positions;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace troupe
