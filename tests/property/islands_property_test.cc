// Steps of several threads give the bits of a step of one, and robots of different islands are independent.
#include <gtest/gtest.h>

#include "common/model/states.h"
#include "tests/support/random_grippers.h"
#include "tests/support/random_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::GripperDemand;
using test::GripperWorld;
using test::RandomStream;

constexpr std::size_t kMin = 1;  // robots, for threads

struct Counts {
  std::size_t islands = 0;
  std::size_t shared = 0;  // robots that share one with another
  std::size_t stalls = 0;
  std::size_t handled = 0;  // objects gripped, released or landed
};

// One tick by one, two and five threads.
class Comparison {
 public:
  explicit Comparison(const WorldDescription& world)
      : scene(world),
        state(InitialState(scene)),
        two_(scene, std::make_shared<ThreadPool>(2), kMin),
        five_(scene, std::make_shared<ThreadPool>(5), kMin),
        bodies_(scene) {}

  void Step(const std::vector<Proposal>& proposals, Counts& counts) {
    Count(proposals, counts);
    const StepResult serial = troupe::Step(scene, state, proposals, bodies_);
    for (Stepper* stepper : {&two_, &five_}) {
      const StepResult parallel = stepper->Step(state, proposals);
      ASSERT_EQ(StateHash(parallel.state), StateHash(serial.state));
      ASSERT_EQ(parallel.state, serial.state);
      ASSERT_EQ(parallel.events, serial.events);
    }
    state = serial.state;
    for (const RobotState& robot : state.robots) counts.stalls += robot.stalled ? 1 : 0;
    for (const Event& event : serial.events) counts.handled += event.object ? 1 : 0;
  }

  const Scene scene;
  WorldState state;

 private:
  void Count(const std::vector<Proposal>& proposals, Counts& counts) {
    std::vector<const Proposal*> by_robot(state.robots.size(), nullptr);
    for (const Proposal& proposal : proposals) by_robot[proposal.robot.index()] = &proposal;
    Islands islands;
    islands.Find(scene, state, by_robot);
    std::size_t robots = 0;
    for (std::size_t i = 0; i < islands.count(); ++i) {
      robots += islands.robots(i).size();
      if (islands.robots(i).size() > 1) counts.shared += islands.robots(i).size();
    }
    ASSERT_EQ(robots, state.robots.size());
    counts.islands += islands.count();
  }

  Stepper two_;
  Stepper five_;
  BodyIndex bodies_;
};

TEST(IslandsProperty, CrowdsMoveBitForBitAsWithOneThread) {
  Counts counts;
  for (std::uint64_t seed = 1; seed <= 150 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random(seed + 21'000'000);
    Comparison run(test::RandomWorld(seed, random.Uniform(3.0, 15.0), random.Index(8), 2 + random.Index(60)));
    for (int tick = 0; tick < 20; ++tick) {
      const double speed = random.Chance(0.05) ? 100.0 : random.Uniform(0.2, 5.0);
      std::vector<Proposal> proposals;
      for (std::size_t i = 0; i < run.state.robots.size(); ++i) {
        if (random.Chance(0.1)) continue;
        proposals.push_back({RobotId(i),
                             {random.Uniform(-0.3, 1.0) * speed, random.Uniform(-0.2, 0.2) * speed,
                              random.Uniform(-1.0, 1.0) * speed}});
      }
      run.Step(proposals, counts);
    }
  }
  EXPECT_GT(counts.islands, 3000u);
  EXPECT_GT(counts.shared, 3000u);
  EXPECT_GT(counts.stalls, 1000u);
}

std::vector<Proposal> Proposals(const Scene& scene, const std::vector<GripperDemand>& demands) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < demands.size(); ++i) {
    proposals.push_back({RobotId(i), demands[i].twist, {}});
    if (scene.joints_of(RobotId(i)).empty()) continue;
    proposals.back().joint_velocities = {demands[i].lift, demands[i].fingers, demands[i].fingers};
  }
  return proposals;
}

// Robots grip, lift, lower, drop and push boxes and stacks of boxes, next to each other and far apart.
TEST(IslandsProperty, GrippersAndFallingStacksMoveBitForBitAsWithOneThread) {
  Counts counts;
  for (std::uint64_t seed = 1; seed <= 150 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random(seed + 22'000'000);
    Comparison run(test::RandomGrippers(random, 10, random.Uniform(0.6, 3.0)).world);
    std::vector<GripperDemand> demands(run.state.robots.size());
    for (int tick = 0; tick < 60; ++tick) {
      for (GripperDemand& demand : demands) {
        if (tick == 0) demand.fingers = 0.1;
        if (tick > 15 && random.Chance(0.12)) demand = test::RandomDemand(random);
      }
      run.Step(Proposals(run.scene, demands), counts);
    }
  }
  EXPECT_GT(counts.islands, 10000u);
  EXPECT_GT(counts.shared, 3000u);
  EXPECT_GT(counts.handled, 500u);
}

// Two robots that face each other close on the same box; one opens, or both drive, in random order. Many such pairs.
TEST(IslandsProperty, HandedOverObjectsMoveBitForBitAsWithOneThread) {
  Counts counts;
  for (std::uint64_t seed = 1; seed <= 100 && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random(seed + 23'000'000);
    GripperWorld world;
    for (std::size_t pair = 0; pair < 1 + random.Index(4); ++pair) {
      const double y = random.Uniform(1.0, 3.0) * static_cast<double>(pair);
      world.AddGripperRobot({0.0, y, 0.0, 0.0});
      world.AddGripperRobot({0.76, y, 0.0, 3.14159});
      world.AddObject({0.38, y, 0.0, 0.0}, 0.1, 0.1);
      if (random.Chance(0.5)) world.AddObject({0.38, y, 0.1, 0.2}, 0.08, 0.1);
    }
    Comparison run(world.world);
    std::vector<GripperDemand> demands(run.state.robots.size());
    for (int tick = 0; tick < 60; ++tick) {
      for (GripperDemand& demand : demands) {
        if (tick == 0) demand.fingers = 0.1;
        if (tick > 15 && random.Chance(0.15)) demand = test::RandomDemand(random);
        if (tick > 15 && random.Chance(0.1)) demand.fingers = random.Chance(0.5) ? -0.2 : 0.1;
      }
      run.Step(Proposals(run.scene, demands), counts);
    }
  }
  EXPECT_GT(counts.shared, 3000u);
  EXPECT_GT(counts.handled, 300u);
}

TEST(IslandsProperty, RobotsFarApartAreIslands) {
  test::TestWorld world;
  for (int i = 0; i < 50; ++i) world.AddRobot(test::Square(0.4), {0.0, 0.3}, {static_cast<double>(i), 0.0, 0.0, 0.0});
  Counts counts;
  Comparison run(world.world);
  run.Step({}, counts);
  EXPECT_EQ(counts.islands, 50u);
  EXPECT_EQ(counts.shared, 0u);
}

}  // namespace
}  // namespace troupe
