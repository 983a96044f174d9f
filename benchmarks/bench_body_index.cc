// The index of moving bodies: assigning a state, and finding near bodies. Argument: robots, 3 m from each other.
#include <benchmark/benchmark.h>

#include "benchmarks/bench_worlds.h"
#include "common/spatial/body_index.h"

namespace troupe {
namespace {

// Every robot has moved by some centimetres.
void BM_AssignMovedState(benchmark::State& state) {
  const Scene scene(bench::SparseWorld(static_cast<std::size_t>(state.range(0)), 1));
  WorldState states[] = {PlacedState(scene.world()), PlacedState(scene.world())};
  for (RobotState& robot : states[1].robots) robot.X_WR.x += 0.05;
  BodyIndex bodies(scene);
  std::size_t turn = 0;
  for (auto _ : state) bodies.Assign(states[turn++ % 2]);
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_AssignMovedState)->Arg(10)->Arg(100)->Arg(1000)->Arg(10'000)->Unit(benchmark::kMicrosecond);

void BM_Query(benchmark::State& state) {
  const Scene scene(bench::SparseWorld(static_cast<std::size_t>(state.range(0)), 1));
  const WorldState world_state = PlacedState(scene.world());
  BodyIndex bodies(scene);
  bodies.Assign(world_state);
  std::pmr::vector<BodyId> near;
  std::size_t i = 0;
  for (auto _ : state) {
    const Pose& pose = world_state.robots[i++ % world_state.robots.size()].X_WR;
    near.clear();
    bodies.Query({pose.x - 4.0, pose.y - 4.0, pose.x + 4.0, pose.y + 4.0}, near);
    benchmark::DoNotOptimize(near.data());
  }
}
BENCHMARK(BM_Query)->Arg(10)->Arg(100)->Arg(1000)->Arg(10'000);

}  // namespace
}  // namespace troupe
