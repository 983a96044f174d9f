// Fans of rays in a cave. Argument: number of robots. With TROUPE_STAGE_WORLDS also the scanners of Stage's cave.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <string>

#include "benchmarks/bench_worlds.h"
#include "common/sensing/sensor_suite.h"
#include "common/spatial/ray_cast.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

constexpr int kRays = 180;

std::vector<double> Bearings() {
  std::vector<double> bearings;
  for (int i = 0; i < kRays; ++i) bearings.push_back(kPi * (i / (kRays - 1.0) - 0.5));
  return bearings;
}

// Moves on to another robot's place in each iteration.
template <typename Cast>
void Run(benchmark::State& state, Cast cast) {
  const Scene scene(bench::CaveWorld(static_cast<std::size_t>(state.range(0)), 12));
  const WorldState world_state = PlacedState(scene.world());
  BodyIndex robots(scene);
  robots.Assign(world_state);
  const std::vector<double> bearings = Bearings();
  std::size_t i = 0;
  for (auto _ : state) {
    const RobotId robot(i++ % world_state.robots.size());
    cast(scene, robots, world_state.robots[robot.index()].X_WR, bearings, robot);
  }
  state.counters["rays"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kRays, benchmark::Counter::kIsRate);
  state.counters["rectangles"] = static_cast<double>(scene.static_index().kept_pieces().size());
  state.counters["robots"] = static_cast<double>(world_state.robots.size());
}

void BM_Fan(benchmark::State& state) {
  std::vector<Ray> rays;
  std::vector<std::optional<RayHit>> hits;
  Run(state, [&](const Scene& scene, const BodyIndex& robots, const Pose& X_WR, const std::vector<double>& bearings,
                 RobotId self) {
    rays.clear();
    for (const double bearing : bearings) {
      const SinCosResult trig = SinCos(X_WR.heading + bearing);
      rays.push_back({X_WR.translation(), {trig.cos, trig.sin}, 0.2, 8.0});
    }
    CastRays(scene, robots, rays, self, hits);
    benchmark::DoNotOptimize(hits.data());
  });
}
BENCHMARK(BM_Fan)->Arg(1)->Arg(100)->Unit(benchmark::kMicrosecond);

void BM_SingleRays(benchmark::State& state) {
  Run(state, [](const Scene& scene, const BodyIndex& robots, const Pose& X_WR, const std::vector<double>& bearings,
                RobotId self) {
    for (double bearing : bearings) {
      const SinCosResult trig = SinCos(X_WR.heading + bearing);
      benchmark::DoNotOptimize(CastRay(scene, robots, {X_WR.translation(), {trig.cos, trig.sin}, 0.2, 8.0}, self));
    }
  });
}
BENCHMARK(BM_SingleRays)->Arg(1)->Arg(100)->Unit(benchmark::kMicrosecond);

// All scanners of 100 robots, one after another, at their poses in Stage's benchmark.
void BM_StageCave(benchmark::State& state) {
  const char* const worlds = std::getenv("TROUPE_STAGE_WORLDS");
  if (worlds == nullptr) return state.SkipWithError("TROUPE_STAGE_WORLDS is not set");
  Result<LoadedWorld> loaded = LoadWorld(std::string(worlds) + "/benchmark/cave.world");
  if (!loaded.ok()) return state.SkipWithError(loaded.error().ToString().c_str());
  const Scene scene(std::move(loaded).value().world);
  BodyIndex bodies(scene);
  bodies.Assign(PlacedState(scene.world()));
  // A subscription and an update of tick 0, as in a robot: readings are reused.
  std::vector<SensorSuite> robots;
  std::int64_t rays_per_iteration = 0;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    SensorSuite& sensors = robots.emplace_back(scene, RobotId(i));
    for (std::size_t j = 0; j < sensors.size(); ++j) {
      const auto* ranger = std::get_if<RangerParameters>(&sensors.sensor(j).description().parameters);
      if (ranger == nullptr || ranger->ray_sensors->size() != 1) continue;  // sonars
      sensors.Subscribe(j);
      rays_per_iteration += ranger->ray_sensors->front().samples;
    }
  }
  for (auto _ : state) {
    for (SensorSuite& sensors : robots) sensors.Update({scene, bodies}, 0);
  }
  const auto rays = static_cast<std::int64_t>(state.iterations()) * rays_per_iteration;
  state.counters["rays"] = benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_StageCave)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace troupe
