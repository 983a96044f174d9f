// Invariants of the step on random worlds with random twists.
#include <gtest/gtest.h>

#include <cmath>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/sweep.h"
#include "tests/support/random_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::RandomStream;

// The deepest overlap of the robots' obstacles with anything of another tree.
double DeepestOfAllPairs(const Scene& scene, const WorldState& state) {
  std::vector<std::vector<ConvexPiece>> bodies(state.robots.size());
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    for (const ConvexPiece& piece : scene.body(BodyId(i)).pieces) {
      bodies[i].push_back(Transformed(piece, state.robots[i].X_WR));
    }
  }
  double deepest = -1.0;
  const auto compare = [&](const std::vector<ConvexPiece>& left, const std::vector<ConvexPiece>& right) {
    for (const ConvexPiece& a : left) {
      for (const ConvexPiece& b : right) {
        if (!a.obstacle || !b.obstacle || !a.z.Overlaps(b.z)) continue;
        if (!BoundingBox(a.vertices).Overlaps(BoundingBox(b.vertices))) continue;
        deepest = std::max(deepest, PenetrationDepth(a.vertices, b.vertices));
      }
    }
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    compare(bodies[i], scene.static_index().kept_pieces());
    for (std::size_t j = i + 1; j < bodies.size(); ++j) compare(bodies[i], bodies[j]);
  }
  return deepest;
}

std::vector<Proposal> RandomProposals(RandomStream& random, std::size_t robots, double speed) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < robots; ++i) {
    if (random.Chance(0.05)) continue;
    Twist twist{random.Uniform(-0.3, 1.0) * speed, random.Uniform(-0.2, 0.2) * speed,
                random.Uniform(-1.0, 1.0) * speed};
    if (random.Chance(0.3)) twist.wz = 0.0;
    if (random.Chance(0.3)) twist.vy = 0.0;
    if (random.Chance(0.05)) twist = {};
    proposals.push_back({RobotId(i), twist});
  }
  return proposals;
}

TEST(StepProperty, NeverMakesTreesOverlap) {
  int stalls = 0;
  int robots = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    RandomStream random(seed + 7'000'000);
    const Scene scene(test::RandomWorld(seed, random.Uniform(3.0, 6.0), random.Index(8), 1 + random.Index(8)));
    WorldState state = InitialState(scene);
    robots += static_cast<int>(state.robots.size());
    ASSERT_LE(DeepestOfAllPairs(scene, state), 0.0) << "seed " << seed;
    for (int tick = 0; tick < 30; ++tick) {
      const double speed = random.Chance(0.1) ? 300.0 : random.Uniform(0.5, 10.0);
      state = Step(scene, state, RandomProposals(random, state.robots.size(), speed)).state;
      for (const RobotState& robot : state.robots) stalls += robot.stalled;
      ASSERT_LE(DeepestOfAllPairs(scene, state), 1.001 * kTouchTolerance) << "seed " << seed << " tick " << tick;
    }
  }
  EXPECT_GT(robots, 1500);
  EXPECT_GT(stalls, 2000);
}

TEST(StepProperty, GivesTheSameStateAndEventsTwice) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    RandomStream random(seed + 8'000'000);
    const WorldDescription world = test::RandomWorld(seed, 4.0, 4, 8);
    const Scene scene(world);
    const Scene again(world);
    WorldState state = InitialState(scene);
    for (int tick = 0; tick < 20; ++tick) {
      const std::vector<Proposal> proposals = RandomProposals(random, state.robots.size(), 5.0);
      const StepResult first = Step(scene, state, proposals);
      const StepResult second = Step(again, state, proposals);
      ASSERT_EQ(first.state, second.state);
      ASSERT_EQ(first.events, second.events);
      ASSERT_EQ(StateHash(first.state), StateHash(second.state));
      state = first.state;
    }
  }
}

TEST(StepProperty, LeavesEveryBitOfAnIdleWorldAlone) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Scene scene(test::RandomWorld(seed, 5.0, 5, 8));
    const WorldState start = InitialState(scene);
    WorldState state = start;
    std::vector<Proposal> standing;
    for (std::size_t i = 0; i < start.robots.size(); ++i) standing.push_back({RobotId(i), {}});
    for (int tick = 0; tick < 200; ++tick)
      state = Step(scene, state, tick % 2 == 0 ? standing : std::vector<Proposal>{}).state;
    ASSERT_EQ(state.tick, 200u);
    ASSERT_EQ(state.robots, start.robots);
  }
}

// A single robot among static models, compared with motion in small steps.
TEST(StepProperty, StopsAtTheFirstContactOfTheWholeTree) {
  constexpr int kSteps = 300;
  int stalls = 0;
  int free = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    RandomStream random(seed + 9'000'000);
    const Scene scene(test::RandomWorld(seed, 7.0, 24, 1));
    if (scene.world().robots.empty()) continue;
    const WorldState start = InitialState(scene);
    const Twist twist{random.Uniform(0.0, 80.0), random.Uniform(-5.0, 5.0), random.Uniform(-30.0, 30.0)};
    const WorldState end = Step(scene, start, std::vector<Proposal>{{RobotId(0), twist}}).state;
    WorldState probe = start;
    double contact_at = 1.0;  // s
    for (int step = 0; step <= kSteps; ++step) {
      const double time = 0.1 * step / kSteps;
      probe.robots[0].X_WR = start.robots[0].X_WR * Integrate(twist, time);
      if (DeepestOfAllPairs(scene, probe) <= kTouchTolerance) continue;
      contact_at = time;
      break;
    }
    if (!end.robots[0].stalled) {
      ++free;
      ASSERT_EQ(contact_at, 1.0) << "seed " << seed;
      continue;
    }
    ++stalls;
    BodyIndex index(scene);
    const BodyId own(0);
    index.Assign(start);
    const std::optional<Contact> contact =
        FirstContact(scene, index, MoverOf(scene, own), {start.robots[0].X_WR, twist, 0.0, 0.1});
    ASSERT_TRUE(contact.has_value());
    ASSERT_LE(contact->time, contact_at) << "seed " << seed;
    // A millimetre further there is overlap.
    const double millimetre = 1e-3 / (std::hypot(twist.vx, twist.vy) + std::abs(twist.wz) * scene.max_body_radius());
    bool met = false;
    for (int step = 1; step <= 100 && !met; ++step) {
      probe.robots[0].X_WR = start.robots[0].X_WR * Integrate(twist, contact->time + millimetre * step / 100);
      met = DeepestOfAllPairs(scene, probe) > kTouchTolerance;
    }
    ASSERT_TRUE(met) << "seed " << seed;
  }
  EXPECT_GT(stalls, 60);
  EXPECT_GT(free, 100);
}

// All bodies on a lattice: edges in line, corners that touch corners, contacts at the same instant.
TEST(StepProperty, NeverMakesTreesOverlapOnALattice) {
  constexpr double kCell = 0.1;
  int stalls = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    RandomStream random(seed + 10'000'000);
    test::TestWorld test;
    constexpr int kWidth = 12;
    std::vector<bool> taken(kWidth * kWidth, false);
    const ModelId walls = test.AddModel(std::vector<Block>{});
    for (int i = 0; i < kWidth * kWidth; ++i) {
      if (!random.Chance(0.15)) continue;
      taken[static_cast<std::size_t>(i)] = true;
      const double x = i % kWidth * kCell;
      const double y = i / kWidth * kCell;
      test.world.shapes[walls.index()].rectangles.push_back({x, y, x + kCell, y + kCell});
    }
    test.world.shapes[walls.index()].rectangles_z = {0.0, 1.0};
    for (int i = 0; i < 8; ++i) {
      const auto place = random.Index(kWidth * kWidth);
      if (taken[place]) continue;
      taken[place] = true;
      const double x = (static_cast<double>(place % kWidth) + 0.5) * kCell;
      const double y = (static_cast<double>(place / kWidth) + 0.5) * kCell;
      test.AddRobot(test::Square(kCell), {0.0, 0.5},
                    {x, y, 0.0, 0.5 * kPi * static_cast<double>(random.Index(4)) - 0.5 * kPi});
    }
    const Scene scene(test.world);
    WorldState state = InitialState(scene);
    for (int tick = 0; tick < 40; ++tick) {
      std::vector<Proposal> proposals;
      for (std::size_t i = 0; i < state.robots.size(); ++i) {
        Twist twist;
        const double speed = (static_cast<double>(random.Index(5)) - 2.0) * kCell / 0.1;
        switch (random.Index(3)) {
          case 0:
            twist.vx = speed;
            break;
          case 1:
            twist.vy = speed;
            break;
          default:
            twist = {speed, random.Chance(0.5) ? speed : 0.0, random.Chance(0.5) ? 5.0 * kPi * speed : 0.0};
        }
        proposals.push_back({RobotId(i), twist});
      }
      state = Step(scene, state, proposals).state;
      for (const RobotState& robot : state.robots) stalls += robot.stalled;
      ASSERT_LE(DeepestOfAllPairs(scene, state), 1.001 * kTouchTolerance) << "seed " << seed << " tick " << tick;
    }
  }
  EXPECT_GT(stalls, 1000);
}

}  // namespace
}  // namespace troupe
