// Steps of a world with objects to grip.
#include <benchmark/benchmark.h>

#include "tests/support/gripper_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

constexpr std::size_t kRobots = 10;

// Ten robots, two metres from each other, each with a box between its fingers; the other boxes in stacks of four beside
// them.
test::GripperWorld Yard(std::size_t objects) {
  test::GripperWorld yard;
  for (std::size_t i = 0; i < kRobots; ++i) yard.AddGripperRobot({0.0, 2.0 * static_cast<double>(i), 0.0, 0.0});
  for (std::size_t i = 0; i < objects; ++i) {
    if (i < kRobots) {
      yard.AddObject({0.35, 2.0 * static_cast<double>(i), 0.0, 0.0});
      continue;
    }
    const std::size_t place = (i - kRobots) / 4;
    const std::size_t level = (i - kRobots) % 4;
    yard.AddObject({2.0 + 0.3 * static_cast<double>(place % 16), 0.3 * static_cast<double>(place / 16),
                    0.1 * static_cast<double>(level), 0.0});
  }
  return yard;
}

// Close, lift, turn, lower, open: forty ticks, over and over; each robot a little later than the one before.
std::vector<Proposal> Proposals(Tick tick) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < kRobots; ++i) {
    const Tick phase = (tick + 4 * i) % 40;
    Proposal proposal{RobotId(i), {}, {0.0, 0.0, 0.0}};
    double& lift = proposal.joint_velocities[0];
    double fingers = 0.0;
    if (phase < 5) {
      fingers = 0.3;
    } else if (phase < 15) {
      lift = 0.5;
    } else if (phase < 25) {
      proposal.twist.wz = 0.5;
    } else if (phase < 35) {
      lift = -0.5;
    } else {
      fingers = -0.3;
    }
    proposal.joint_velocities[1] = proposal.joint_velocities[2] = fingers;
    proposals.push_back(std::move(proposal));
  }
  return proposals;
}

// Argument: objects, of which up to ten are handled.
void BM_StepWithObjects(benchmark::State& state) {
  const Scene scene(Yard(static_cast<std::size_t>(state.range(0))).world);
  WorldState world_state = InitialState(scene);
  BodyIndex bodies(scene);
  std::int64_t held = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const std::vector<Proposal> proposals = Proposals(world_state.tick);
    state.ResumeTiming();
    world_state = Step(scene, world_state, proposals, bodies).state;
    for (const ObjectState& object : world_state.objects) held += object.mode == ObjectMode::kHeld;
  }
  state.counters["held"] = benchmark::Counter(static_cast<double>(held), benchmark::Counter::kAvgIterations);
}
BENCHMARK(BM_StepWithObjects)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);

// No robot moves. Argument: objects.
void BM_StepWithIdleObjects(benchmark::State& state) {
  const Scene scene(Yard(static_cast<std::size_t>(state.range(0))).world);
  WorldState world_state = InitialState(scene);
  BodyIndex bodies(scene);
  for (auto _ : state) world_state = Step(scene, world_state, {}, bodies).state;
}
BENCHMARK(BM_StepWithIdleObjects)->Arg(10)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace troupe
