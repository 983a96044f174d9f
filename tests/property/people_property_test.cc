// People never are in walls, robots, objects or each other, and steps of several threads have equal bits.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/model/states.h"
#include "tests/support/people_world.h"
#include "tests/support/random_world.h"
#include "world-service/core/find_overlap.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::PeopleWorld;
using test::RandomStream;

// Concave walls, robots of any heights, boxes, and people of all kinds, all at places of their own; goals anywhere,
// also in walls.
WorldDescription CrowdedWorld(std::uint64_t seed, std::size_t people) {
  RandomStream random(seed);
  PeopleWorld test;
  constexpr double kPitch = 1.7;  // m, between places
  constexpr int kSide = 10;       // places along a side
  std::vector<Vec2> places;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) places.emplace_back(kPitch * column, kPitch * row);
  }
  const auto place = [&] {
    const std::size_t index = random.Index(places.size());
    const Vec2 at = places[index];
    places.erase(places.begin() + static_cast<std::ptrdiff_t>(index));
    return at;
  };
  for (int i = 0; i < 8; ++i) {
    const Polygon star = test::RandomStar(random, Vec2::Zero(), 0.1, 0.8);
    const ZRange heights = test::RandomHeights(random);
    const Vec2 at = place();
    test.AddModel(star, heights, {at.x(), at.y(), 0.0, random.Angle()});
  }
  for (int i = 0; i < 4; ++i) {
    const Vec2 at = place();
    test.world.objects.push_back(test.AddModel(test::Square(0.5), {0.0, 0.4}, {at.x(), at.y(), 0.0, 0.0}));
    test.world.models.back().gripper_return = true;
  }
  for (int i = 0; i < 8; ++i) {
    const Polygon star = test::RandomStar(random, Vec2::Zero(), 0.2, 0.5);
    const ZRange heights = test::RandomHeights(random);
    const Vec2 at = place();
    test.AddRobot(star, heights, {at.x(), at.y(), 0.0, random.Angle()});
  }
  std::vector<Vec2> goals;
  for (int i = 0; i < 6; ++i) goals.emplace_back(random.Uniform(-2.0, 18.0), random.Uniform(-2.0, 18.0));
  const std::uint32_t anywhere = test.AddGoals(goals, {0.0, 1.0});
  for (std::size_t i = 0; i < people && !places.empty(); ++i) {
    const auto reaction = static_cast<PersonReaction>(random.Index(4));
    const double radius = random.Uniform(0.15, 0.4);
    test.AddPerson(place(), anywhere, reaction, radius);
    if (i > 0 && random.Chance(0.2)) {
      const PersonDescription& before = test.world.people[i - 1];
      test.world.people[i].leader = before.leader ? before.leader : std::optional(PersonId(i - 1));
    }
  }
  test.world.seed = seed;
  EXPECT_TRUE(Validate(test.world).ok()) << Validate(test.world).error().message;
  return test.world;
}

std::vector<Proposal> RandomProposals(RandomStream& random, std::size_t robots) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < robots; ++i) {
    if (random.Chance(0.1)) continue;
    const double vx = random.Uniform(-1.0, 2.0);
    const double wz = random.Chance(0.3) ? 0.0 : random.Uniform(-2.0, 2.0);
    proposals.push_back({RobotId(i), Twist{vx, 0.0, wz}});
  }
  return proposals;
}

TEST(PeopleProperty, NoPersonIsEverInAWallOrInAnotherBody) {
  double walked = 0.0;
  std::size_t stalls = 0;
  for (std::uint64_t seed = 1; seed <= 25 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random(seed + 40'000'000);
    const Scene scene(CrowdedWorld(seed, 40));
    WorldState state = InitialState(scene);
    BodyIndex bodies(scene);
    for (int tick = 0; tick < 150 && !HasFailure(); ++tick) {
      const WorldState before = state;
      state = Step(scene, state, RandomProposals(random, state.robots.size()), bodies).state;
      for (std::size_t i = 0; i < state.people.size(); ++i) {
        const ModelId root = scene.world().people[i].root;
        const std::optional<ModelId> other = FindOverlap(scene, state, root);
        ASSERT_FALSE(other) << "tick " << tick << ": person " << i << " is in " << scene.world().model(*other).name;
        walked += (state.people[i].X_WP.translation() - before.people[i].X_WP.translation()).norm();
      }
      for (const RobotState& robot : state.robots) stalls += robot.stalled ? 1 : 0;
    }
  }
  EXPECT_GT(walked, 10'000.0);  // so that it has been hard
  EXPECT_GT(stalls, 1'000u);
}

TEST(PeopleProperty, StepsOfSeveralThreadsHaveTheBitsOfOne) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random(seed + 41'000'000);
    const Scene scene(CrowdedWorld(seed, 75));
    ASSERT_GE(scene.world().people.size(), Stepper::kMinPeople);
    WorldState state = InitialState(scene);
    BodyIndex bodies(scene);
    Stepper two(scene, std::make_shared<ThreadPool>(2));      // robots by one thread
    Stepper five(scene, std::make_shared<ThreadPool>(5), 1);  // and by several
    for (int tick = 0; tick < 60; ++tick) {
      const std::vector<Proposal> proposals = RandomProposals(random, state.robots.size());
      const StepResult serial = Step(scene, state, proposals, bodies);
      for (Stepper* stepper : {&two, &five}) {
        const StepResult parallel = stepper->Step(state, proposals);
        ASSERT_EQ(StateHash(parallel.state), StateHash(serial.state)) << "tick " << tick;
        ASSERT_EQ(parallel.state, serial.state);
        ASSERT_EQ(parallel.events, serial.events);
      }
      ASSERT_EQ(Step(scene, state, proposals).state, serial.state);  // without an index of before
      state = serial.state;
    }
  }
}

}  // namespace
}  // namespace troupe
