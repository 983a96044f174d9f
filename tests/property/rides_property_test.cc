// People in houses of several levels: none is ever in a wall, a leaf, a cabin or another body, none is lost between
// levels, each reaches other levels again and again, robots that call the lift are served, and threads change nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <set>
#include <vector>

#include "common/model/states.h"
#include "common/spatial/walk_routes.h"
#include "tests/support/house_world.h"
#include "tests/support/random_world.h"
#include "world-service/core/find_overlap.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

using test::HouseWorld;
using test::RandomStream;

// People at random places of all levels, whose tours lead through the doors and to all levels.
HouseWorld RandomHouse(RandomStream& random, std::size_t levels, std::size_t people) {
  HouseWorld house(levels, static_cast<HouseWorld::Leaf>(random.Index(4)), random.Uniform(1.5, 8.5),
                   random.Uniform(2.0, 2.6));
  const RobotId robot = house.AddRobot(test::Square(0.6), {0.0, 0.6}, {12.0, 1.0, 0.0, 0.0});
  EXPECT_EQ(robot, RobotId(0));
  std::vector<HouseWorld::Place> places;
  for (std::size_t level = 0; level < levels; ++level) {
    for (int column = 0; column < 11; ++column) {
      for (int row = 0; row < 7; ++row) {
        const Vec2 at(2.6 + 1.0 * column, 1.2 + 1.2 * row);
        if (at.x() > 7.0 && at.x() < 9.2) continue;
        if (at.x() > 10.8 && at.y() < 2.4) continue;
        places.push_back({at, level});
      }
    }
  }
  const auto draw = [&] { return places[random.Index(places.size())]; };
  std::set<std::size_t> taken;
  for (std::size_t i = 0; i < people; ++i) {
    std::vector<HouseWorld::Place> tour{draw(), draw(), draw()};
    tour[1].level = (tour[0].level + 1) % levels;
    const std::uint32_t goals = house.AddTour(tour, {0.0, 3.0});
    std::size_t start = random.Index(places.size());
    while (!taken.insert(start).second) start = (start + 1) % places.size();
    house.AddPersonOn(places[start].level, places[start].at, goals, random.Chance(0.2) ? 0.2 : 0.25);
  }
  house.world.seed = random.Index(1000);
  EXPECT_TRUE(Validate(house.world).ok()) << Validate(house.world).error().message;
  return house;
}

// The robot stands aside and calls the lift to a floor; it ends its session 5 s after it is there.
class Caller {
 public:
  std::vector<Proposal> Propose(const Scene& scene, const WorldState& state, RandomStream& random) {
    Proposal proposal{RobotId(0), {}};
    const LiftState& lift = state.lifts[0];
    if (!called_ && random.Chance(0.002)) {
      floor_ = random.Index(scene.world().lifts[0].floors.size());
      called_ = state.tick;
      proposal.orders.push_back(LiftOrder{0, floor_});
    } else if (called_ && lift.floor == floor_ && lift.z == scene.world().lifts[0].floors[floor_].z) {
      longest = std::max(longest, arrived_ ? Tick{0} : state.tick - *called_);
      if (!arrived_) arrived_ = state.tick;
      if (state.tick - *arrived_ >= 50) {
        proposal.orders.push_back(LiftOrder{0, 0, true});
        called_.reset();
        arrived_.reset();
        ++served;
      }
    }
    return {proposal};
  }
  Tick longest = 0;  // from a call to the arrival
  int served = 0;

 private:
  std::size_t floor_ = 0;
  std::optional<Tick> called_;
  std::optional<Tick> arrived_;
};

bool IsOnALevelOrInTheCabin(const Scene& scene, const WorldState& state, std::size_t person) {
  const Pose& pose = state.people[person].X_WP;
  const LiftPortal& lift = scene.walk_routes().portals().lifts[0];
  if (lift.IsInside(pose.translation(), pose.z - state.lifts[0].z)) return true;
  for (const LiftFloor& floor : scene.world().lifts[0].floors) {
    if (std::abs(pose.z - floor.z) < 1e-9) return pose.x > -0.7 && pose.x < 14.0 && pose.y > 0.0 && pose.y < 10.0;
  }
  return false;
}

TEST(RidesProperty, AllReachTheOtherLevelsAndNoneIsInAnotherBody) {
  constexpr Tick kMaxLength = 4000;
  Tick longest_trip = 0;
  Tick longest_call = 0;
  int served = 0;
  std::size_t rides = 0;
  for (std::uint64_t seed = 1; seed <= 8 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomStream random(seed + 43'000'000);
    const std::size_t levels = 2 + seed % 3;
    const Scene scene(RandomHouse(random, levels, 10 + 2 * seed).world);
    WorldState state = InitialState(scene);
    BodyIndex bodies(scene);
    Caller robot;
    std::vector<std::size_t> level(state.people.size());
    std::vector<Tick> changed(state.people.size(), 0);
    for (std::size_t i = 0; i < level.size(); ++i) level[i] = scene.walk_routes().LevelAt(state.people[i].X_WP.z);
    for (int tick = 0; tick < 5000 && !HasFailure(); ++tick) {
      state = Step(scene, state, robot.Propose(scene, state, random), bodies).state;
      ASSERT_TRUE(CheckState(scene.world(), state).ok()) << CheckState(scene.world(), state).error().message;
      for (std::size_t i = 0; i < state.people.size(); ++i) {
        const std::optional<ModelId> other = FindOverlap(scene, state, scene.world().people[i].root);
        ASSERT_FALSE(other) << "tick " << tick << ": person " << i << " is in " << scene.world().model(*other).name;
        ASSERT_TRUE(IsOnALevelOrInTheCabin(scene, state, i))
            << "tick " << tick << ": person " << i << " at z " << state.people[i].X_WP.z;
        if (state.people[i].lift == 0) {
          const std::size_t now = scene.walk_routes().LevelAt(state.people[i].X_WP.z);
          if (now != level[i]) {
            ++rides;
            longest_trip = std::max(longest_trip, state.tick - changed[i]);
            changed[i] = state.tick;
            level[i] = now;
          }
        }
        ASSERT_LT(state.tick - changed[i], kMaxLength) << "person " << i << " does not reach another level";
      }
    }
    longest_call = std::max(longest_call, robot.longest);
    served += robot.served;
  }
  std::cout << rides << " rides, at most " << longest_trip << " ticks from one level to the next; " << served
            << " calls of robots, served within " << longest_call << " ticks\n";
  EXPECT_GT(rides, 500u);
  EXPECT_GT(served, 10);
  EXPECT_LT(longest_call, 600u);
}

TEST(RidesProperty, StepsOfSeveralThreadsHaveTheBitsOfOne) {
  RandomStream random(44'000'000);
  const Scene scene(RandomHouse(random, 3, 60).world);
  ASSERT_GE(scene.world().people.size(), Stepper::kMinPeople);
  WorldState state = InitialState(scene);
  BodyIndex bodies(scene);
  Stepper two(scene, std::make_shared<ThreadPool>(2));
  Caller robot;
  std::size_t aboard = 0;
  for (int tick = 0; tick < 600; ++tick) {
    const std::vector<Proposal> proposals = robot.Propose(scene, state, random);
    const StepResult serial = Step(scene, state, proposals, bodies);
    const StepResult parallel = two.Step(state, proposals);
    ASSERT_EQ(StateHash(parallel.state), StateHash(serial.state)) << "tick " << tick;
    ASSERT_EQ(parallel.state, serial.state);
    state = serial.state;
    for (const PersonState& person : state.people) aboard += person.place != 0 ? 1 : 0;
  }
  EXPECT_GT(aboard, 500u);
}

}  // namespace
}  // namespace troupe
