// Ten expectations on a cave with robots, beside the step that they watch: the share is that of BM_TenExpectations in
// BM_StepBesideThem, which has neither sensors nor controllers.
#include <benchmark/benchmark.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/bench_worlds.h"
#include "testing/expectations/tick_view.h"
#include "troupe/expectation.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

constexpr const char* kTen[] = {
    "no_contact(1 mm)",
    "all_alive",
    "forall r: always (stalled(r) -> eventually[0, 10 s] not stalled(r))",
    "forall r: eventually[0, 300 s] at(r, dock)",
    "forall r: always speed(r) <= 1 m/s",
    "forall r: always abs(wz(r)) < 180 deg/s",
    "within(cave)",
    "always (count r: stalled(r)) < 90",
    "always[10 s, end] (mean r: speed(r)) > 0.001 m/s or true",
    "forall r: always (event(stall_began, r) -> once[0, 5 s] speed(r) > 0.1 m/s)",
};

struct Run {
  Scene scene;
  std::vector<WorldState> states;
  std::vector<std::vector<Event>> events;
};

std::vector<Proposal> Proposals(const WorldState& state) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    Twist twist{.vx = 0.5, .vy = 0.0, .wz = 2.0 * RandomUniform({i, state.tick / 16}) - 1.0};
    if (state.robots[i].stalled) twist.vx = -0.3;
    proposals.push_back({RobotId(i), twist});
  }
  return proposals;
}

WorldDescription World(std::size_t robots) {
  WorldDescription world = bench::CaveWorld(robots, 1);
  world.places.push_back({"dock", {}, {}, {}});
  return world;
}

Run Record(std::size_t robots, std::size_t ticks) {
  Run run{Scene(World(robots)), {}, {}};
  BodyIndex bodies(run.scene);
  run.states.push_back(InitialState(run.scene));
  run.events.emplace_back();
  while (run.states.size() < ticks) {
    StepResult next = Step(run.scene, run.states.back(), Proposals(run.states.back()), bodies);
    run.states.push_back(std::move(next.state));
    run.events.push_back(std::move(next.events));
  }
  return run;
}

void BM_TenExpectations(benchmark::State& state) {
  const Run run = Record(static_cast<std::size_t>(state.range(0)), 400);
  const double half = 0.5 * bench::kCaveWidth;
  const NamedRegion cave{"cave", {{-half, -half}, {half, -half}, {half, half}, {-half, half}}};
  std::vector<Monitor> fresh;
  for (const char* const text : kTen) {
    fresh.emplace_back(Expectation::Parse(text, {run.scene.world(), std::span(&cave, 1)}).value());
  }
  BodyIndex bodies(run.scene);
  std::vector<Monitor> monitors = fresh;
  std::size_t tick = 0;
  for (auto _ : state) {
    state.PauseTiming();
    if (tick == run.states.size()) {
      monitors = fresh;
      tick = 0;
    }
    bodies.Assign(run.states[tick]);  // the step needs it, too
    state.ResumeTiming();
    const TickView view{run.scene, bodies, run.states[tick], run.events[tick]};
    for (Monitor& monitor : monitors) benchmark::DoNotOptimize(monitor.Push(view).ok());
    ++tick;
  }
}
BENCHMARK(BM_TenExpectations)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);

void BM_StepBesideThem(benchmark::State& state) {
  const Scene scene(World(static_cast<std::size_t>(state.range(0))));
  WorldState world_state = InitialState(scene);
  BodyIndex bodies(scene);
  for (auto _ : state) {
    state.PauseTiming();
    const std::vector<Proposal> proposals = Proposals(world_state);
    state.ResumeTiming();
    world_state = Step(scene, world_state, proposals, bodies).state;
  }
}
BENCHMARK(BM_StepBesideThem)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace troupe
