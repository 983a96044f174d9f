// The cost of one measurement of each kind of sensor, in a cave with 100 robots; moves on to another robot's place in
// each iteration.
#include <benchmark/benchmark.h>

#include <memory>
#include <utility>
#include <vector>

#include "benchmarks/bench_worlds.h"
#include "common/sensing/sensor_suite.h"

namespace troupe {
namespace {

constexpr std::size_t kRobots = 100;

// The sensor 0.2 m above the ground on every robot.
WorldDescription CaveWithSensors(const SensorParameters& parameters) {
  WorldDescription world = bench::CaveWorld(kRobots, 4);
  for (RobotDescription& robot : world.robots) {
    world.models[robot.root.index()].fiducial_return = 1;
    ModelDescription model;
    model.name = robot.name + ".sensor";
    model.type = std::string(TypeOf(parameters));
    model.parent = robot.root;
    model.X_PM = {0.0, 0.0, 0.2, 0.0};
    model.shape = ShapeId(world.shapes.size());
    world.shapes.emplace_back();
    robot.sensors.push_back(
        {.name = "sensor", .model = ModelId(world.models.size()), .period_ticks = 1, .parameters = parameters});
    world.models.push_back(std::move(model));
  }
  return world;
}

// `samples`: of one measurement, for the rate.
void Measure(benchmark::State& state, const SensorParameters& parameters, double samples) {
  const Scene scene(CaveWithSensors(parameters));
  WorldState world_state = PlacedState(scene.world());
  if (std::holds_alternative<RadioParameters>(parameters)) {
    for (std::size_t robot = 0; robot < kRobots; ++robot) {
      world_state.transmissions.push_back(
          {.from = RobotId(robot), .message = {.radio = 0, .bytes = std::vector<std::uint8_t>(32)}});
    }
  }
  BodyIndex bodies(scene);
  bodies.Assign(world_state);
  std::vector<std::unique_ptr<const Sensor>> sensors;
  for (std::size_t i = 0; i < kRobots; ++i) sensors.push_back(std::move(MakeSensors(scene, RobotId(i))[0]));
  std::size_t i = 0;
  for (auto _ : state) {
    SensorReading reading = sensors[i++ % kRobots]->Measure({scene, bodies, &world_state}, 0);
    benchmark::DoNotOptimize(reading);
  }
  state.counters["samples"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * samples, benchmark::Counter::kIsRate);
}

void BM_Camera(benchmark::State& state) {
  const CameraParameters camera{.X_MS = {}, .width = 320, .height = 240};
  Measure(state, camera, 320.0 * 240.0);
}
BENCHMARK(BM_Camera)->Unit(benchmark::kMicrosecond);

// Argument: planes.
void BM_Lidar(benchmark::State& state) {
  RaySensorDescription scanner;
  scanner.range = {0.0, 30.0};
  scanner.fov = 2.0 * kPi;
  scanner.samples = 1800;
  const auto planes = static_cast<int>(state.range(0));
  for (int i = 0; i < planes; ++i) scanner.elevations.push_back(DegreesToRadians(-15.0 + 30.0 * i / (planes - 1)));
  Measure(state, RangerParameters{{scanner}}, 1800.0 * planes);
}
BENCHMARK(BM_Lidar)->Arg(16)->Arg(64)->Unit(benchmark::kMicrosecond);

void BM_Fiducial(benchmark::State& state) {
  Measure(state, FiducialParameters{}, 1.0);
}
BENCHMARK(BM_Fiducial)->Unit(benchmark::kMicrosecond);

void BM_Blobfinder(benchmark::State& state) {
  Measure(state, BlobfinderParameters{}, 80.0);
}
BENCHMARK(BM_Blobfinder)->Unit(benchmark::kMicrosecond);

void BM_Bumper(benchmark::State& state) {
  BumperParameters bumper;
  bumper.height = 0.1;
  for (int i = 0; i < 4; ++i) {
    bumper.segments.push_back({Pose{0.0, 0.0, 0.0, WrapAngle(0.5 * kPi * i)} * Pose{0.2, 0.0, 0.0, 0.0}, 0.4});
  }
  Measure(state, bumper, 4.0);
}
BENCHMARK(BM_Bumper)->Unit(benchmark::kMicrosecond);

// All robots send to all, in each tick. Argument: range, m. A tick of the 100 robots needs 100 of these measurements.
void BM_Radio(benchmark::State& state) {
  Measure(state, RadioParameters{.range = static_cast<double>(state.range(0))}, kRobots - 1.0);
}
BENCHMARK(BM_Radio)->Arg(2)->Arg(5)->Arg(20)->Unit(benchmark::kMicrosecond);

void BM_Contact(benchmark::State& state) {
  Measure(state, ContactParameters{}, 1.0);
}
BENCHMARK(BM_Contact)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace troupe
