// The demo and the swarm of worlds/scenarios behave as intended.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "tests/worldfile/scenario_run.h"
#include "worldfile/scenario/scenario.h"

namespace troupe {
namespace {

ScenarioRun Load(const std::string& name) {
  const std::string path = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/" + name;
  Result<LoadedWorld> loaded = LoadScenario(path);
  EXPECT_TRUE(loaded.ok()) << loaded.error().ToString();
  return ScenarioRun(loaded.ok() ? std::move(loaded).value().world : WorldDescription{});
}

TEST(DemoScenario, EveryRobotDrivesAndNoneIsEverInsideAWall) {
  ScenarioRun run = Load("demo.json");
  const std::vector<RobotDescription>& robots = run.scene().world().robots;
  ASSERT_EQ(robots.size(), 8u);
  std::vector<double> farthest(robots.size(), 0.0);
  const WorldState start = run.state();
  for (int i = 0; i < 40; ++i) {
    run.Run(10);
    for (std::size_t r = 0; r < robots.size(); ++r) {
      EXPECT_FALSE(run.InsideSomething(robots[r].name)) << robots[r].name << " at tick " << run.state().tick;
      const Vec2 moved = run.state().robots[r].X_WR.translation() - start.robots[r].X_WR.translation();
      farthest[r] = std::max(farthest[r], moved.norm());
    }
  }
  for (std::size_t r = 0; r < robots.size(); ++r) EXPECT_GT(farthest[r], 1.0) << robots[r].name;
}

TEST(DemoScenario, ScoutsDriveUnderTablesToAndFroWithoutAStall) {
  ScenarioRun run = Load("demo.json");
  run.Run(75);
  EXPECT_GT(run["carl"].X_WR.x, -0.9);  // beyond the table at -2
  EXPECT_GT(run["dora"].X_WR.x, 7.2);   // under the far end of the table at 6
  run.Run(300);
  EXPECT_FALSE(run.EverStalled("carl"));
  EXPECT_FALSE(run.EverStalled("dora"));
}

// In a minute of wandering each kind of sensor finds something.
TEST(SensorsScenario, EveryKindOfSensorFindsSomething) {
  ScenarioRun run = Load("sensors.json");
  std::vector<std::unique_ptr<const Sensor>> sensors = MakeSensors(run.scene(), run.Find("scout"));
  for (auto& sensor : MakeSensors(run.scene(), run.Find("blind"))) sensors.push_back(std::move(sensor));
  std::map<std::string, int> found;
  const auto count = [&](const SensorReading& reading, const std::string& name) {
    bool any = false;
    if (const auto* const fiducials = reading.As<FiducialReading>()) any = !fiducials->fiducials.empty();
    if (const auto* const blobs = reading.As<BlobfinderReading>()) any = !blobs->blobs.empty();
    if (const auto* const contacts = reading.As<ContactReading>()) any = !contacts->contacts.empty();
    if (const auto* const bumper = reading.As<BumperReading>()) {
      for (const BumperReading::Segment& segment : bumper->segments) any = any || segment.pressed_by.has_value();
    }
    if (const auto* const view = reading.As<CameraReading>()) {
      any = std::any_of(view->models.begin(), view->models.end(), [](std::int32_t model) { return model >= 0; });
    }
    if (const RangerReading* const ranger = reading.ranger()) {
      const RangeScan& scan = ranger->scans[0];
      any = std::any_of(scan.ranges.begin(), scan.ranges.end(), [&](double r) { return r < scan.limits.max; });
    }
    if (const auto* const imu = reading.As<ImuReading>()) any = imu->turn != 0.0 && imu->force_xy.norm() > 0.0;
    found[name] += any ? 1 : 0;
  };
  BodyIndex bodies(run.scene());
  for (int tick = 0; tick < 600; ++tick) {
    run.Run(1);
    bodies.Assign(run.state());
    for (const auto& sensor : sensors) {
      if (tick % 4 == 0)
        count(sensor->Measure({run.scene(), bodies, &run.state()}, run.state().tick), sensor->description().name);
    }
  }
  for (const auto& sensor : sensors) EXPECT_GT(found[sensor->description().name], 0) << sensor->description().name;
}

TEST(SwarmScenario, SpreadsWithoutARobotInsideAnything) {
  ScenarioRun run = Load("swarm.json");
  const std::vector<RobotDescription>& robots = run.scene().world().robots;
  ASSERT_EQ(robots.size(), 100u);
  for (int i = 0; i < 4; ++i) {
    run.Run(25);
    for (const RobotDescription& robot : robots) {
      EXPECT_FALSE(run.InsideSomething(robot.name)) << robot.name << " at tick " << run.state().tick;
    }
  }
}

}  // namespace
}  // namespace troupe
