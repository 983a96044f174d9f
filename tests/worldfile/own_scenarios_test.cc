// The demo and the swarm of worlds/scenarios behave as intended.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "common/worldfile/scenario/scenario.h"
#include "tests/worldfile/scenario_run.h"

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
