// The core by itself, without files, controllers or transports: a crowd of robots among static models. The constants
// are the same on every machine and with every compiler flag set that the project has; if they change without intent,
// runs are no longer repeatable. After an intended change of behaviour, replace them by the values that the test
// prints.
#include <gtest/gtest.h>

#include "common/base/hash.h"
#include "common/model/states.h"
#include "common/spatial/ray_cast.h"
#include "tests/support/random_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

constexpr std::uint64_t kSeed = 2026;
constexpr Tick kTicks = 300;

WorldDescription Crowd() {
  return test::RandomWorld(kSeed, 12.0, 25, 60);
}

// Twists that depend only on the robot, the tick and the robot's stall flag.
std::vector<Proposal> Proposals(const WorldState& state) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    test::RandomStream random(RandomBits({kSeed, i, state.tick / 10}));
    if (random.Chance(0.05)) continue;
    Twist twist{random.Uniform(0.2, 3.0), random.Uniform(-0.3, 0.3), random.Uniform(-2.0, 2.0)};
    if (state.robots[i].stalled) twist.vx = -twist.vx;
    if (random.Chance(0.02)) twist.vx *= 100.0;
    proposals.push_back({RobotId(i), twist});
  }
  return proposals;
}

struct Outcome {
  std::uint64_t hashes = 0;  // of the state hashes of all ticks
  std::uint64_t last = 0;
  std::uint64_t events = 0;
  std::uint64_t ranges = 0;
  int stalls = 0;
};

Outcome RunCrowd() {
  const Scene scene(Crowd());
  WorldState state = InitialState(scene);
  BodyIndex robots(scene);
  Hasher hashes;
  Hasher events;
  Hasher ranges;
  Outcome run;
  std::vector<double> bearings;
  for (int i = 0; i < 32; ++i) bearings.push_back(2.0 * kPi * i / 32.0);
  std::vector<Ray> rays;
  std::vector<std::optional<RayHit>> hits;
  while (state.tick < kTicks) {
    StepResult result = Step(scene, state, Proposals(state));
    state = std::move(result.state);
    hashes.Add(StateHash(state));
    for (const Event& event : result.events) {
      ++run.stalls;
      events.Add(event.tick);
      events.Add(static_cast<std::uint64_t>(event.type));
      events.Add(std::uint64_t{event.robot ? event.robot->index() + 1 : 0});
      events.Add(std::uint64_t{event.other ? event.other->index() + 1 : 0});
    }
    robots.Assign(state);
    for (std::size_t i = 0; i < state.robots.size(); i += 7) {
      const Pose& X_WR = state.robots[i].X_WR;
      rays.clear();
      for (const double bearing : bearings) {
        const SinCosResult trig = SinCos(X_WR.heading + bearing);
        rays.push_back({X_WR.translation(), {trig.cos, trig.sin}, 0.3, 8.0});
      }
      CastRays(scene, robots, rays, RobotId(i), hits);
      for (const auto& hit : hits) ranges.Add(hit ? hit->distance : -1.0);
    }
  }
  run.hashes = hashes.value();
  run.last = StateHash(state);
  run.events = events.value();
  run.ranges = ranges.value();
  return run;
}

TEST(CoreRun, DescriptionHasItsKnownHash) {
  EXPECT_EQ(Hash(Crowd()), 0xcf370309ef18ca81u);
}

TEST(CoreRun, StatesEventsAndRangesHaveTheirKnownHashes) {
  const Outcome run = RunCrowd();
  EXPECT_GT(run.stalls, 300) << "too little happens";
  EXPECT_EQ(run.hashes, 0xe68559858bcf2356u);
  EXPECT_EQ(run.last, 0xfc2f7f3689aae030u);
  EXPECT_EQ(run.events, 0x3ba595428407b1fau);
  EXPECT_EQ(run.ranges, 0xf2dff4a018e48384u);
}

}  // namespace
}  // namespace troupe
