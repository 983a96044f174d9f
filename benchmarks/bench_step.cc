// Steps of a whole world.
#include <benchmark/benchmark.h>

#include "benchmarks/bench_worlds.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

// Drives that turn away after a stall; the twist changes now and then.
std::vector<Proposal> Proposals(const WorldState& state) {
  std::vector<Proposal> proposals;
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    const std::uint64_t period = state.tick / 16;
    Twist twist{.vx = 0.5, .vy = 0.0, .wz = 2.0 * RandomUniform({i, period}) - 1.0};
    if (state.robots[i].stalled) twist.vx = -0.3;
    proposals.push_back({RobotId(i), twist});
  }
  return proposals;
}

void Run(benchmark::State& state, const Scene& scene) {
  WorldState world_state = InitialState(scene);
  BodyIndex bodies(scene);
  std::int64_t stalls = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const std::vector<Proposal> proposals = Proposals(world_state);
    state.ResumeTiming();
    world_state = Step(scene, world_state, proposals, bodies).state;
    for (const RobotState& robot : world_state.robots) stalls += robot.stalled;
  }
  state.counters["robots"] = static_cast<double>(world_state.robots.size());
  state.counters["stalled"] = benchmark::Counter(static_cast<double>(stalls), benchmark::Counter::kAvgIterations);
}

// Robots among rock: arguments robots, blocks of each.
void BM_StepInCave(benchmark::State& state) {
  Run(state, Scene(bench::CaveWorld(static_cast<std::size_t>(state.range(0)), static_cast<int>(state.range(1)))));
}
BENCHMARK(BM_StepInCave)->Args({100, 1})->Args({100, 12})->Unit(benchmark::kMicrosecond);

// Robots on an empty plane: arguments robots, blocks of each.
void BM_StepSparse(benchmark::State& state) {
  Run(state, Scene(bench::SparseWorld(static_cast<std::size_t>(state.range(0)), static_cast<int>(state.range(1)))));
}
BENCHMARK(BM_StepSparse)
    ->Args({10, 1})
    ->Args({100, 1})
    ->Args({1000, 1})
    ->Args({10'000, 1})
    ->Args({100, 12})
    ->Unit(benchmark::kMicrosecond);

// People in a hall: argument people. One thread.
void BM_StepPeople(benchmark::State& state) {
  const Scene scene(bench::HallWorld(static_cast<std::size_t>(state.range(0))));
  WorldState world_state = InitialState(scene);
  BodyIndex bodies(scene);
  for (int i = 0; i < 20; ++i) world_state = Step(scene, world_state, {}, bodies).state;  // the ways to goals are known
  for (auto _ : state) world_state = Step(scene, world_state, {}, bodies).state;
  state.counters["people"] = static_cast<double>(world_state.people.size());
}
BENCHMARK(BM_StepPeople)->Arg(200)->Arg(2000)->Unit(benchmark::kMillisecond);

// Loading: the index over a large map. Argument: rectangles.
void BM_BuildScene(benchmark::State& state) {
  WorldDescription world;
  ModelDescription map;
  map.name = "map";
  map.shape = ShapeId(0);
  world.models = {map};
  world.shapes.resize(1);
  const auto width = static_cast<std::int64_t>(std::sqrt(static_cast<double>(state.range(0))));
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    const double x = 0.2 * static_cast<double>(i % width);
    const double y = 0.2 * static_cast<double>(i / width);
    world.shapes[0].rectangles.push_back({x, y, x + 0.15, y + 0.1});
  }
  world.shapes[0].rectangles_z = {0.0, 1.0};
  for (auto _ : state) {
    const Scene scene(world);
    benchmark::DoNotOptimize(&scene);
  }
}
BENCHMARK(BM_BuildScene)->Arg(1000)->Arg(200'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace troupe
