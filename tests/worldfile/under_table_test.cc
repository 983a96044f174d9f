// Robots that drive under tables, against them and against each other: in worlds/scenarios/under_table.json, and in
// Stage's model of a real lab.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "tests/support/stage_worlds.h"
#include "tests/worldfile/scenario_run.h"
#include "worldfile/load_world.h"
#include "worldfile/scenario/scenario.h"

namespace troupe {
namespace {

using test::StageWorldsFolder;

constexpr double kMillimetre = 1e-3;

std::string SourceFolder() {
  return std::getenv("TROUPE_SOURCE_DIR");
}

ScenarioRun LoadAndRun(Result<LoadedWorld> loaded, int ticks) {
  EXPECT_TRUE(loaded.ok()) << loaded.error().ToString();
  ScenarioRun run(loaded.ok() ? std::move(loaded).value().world : WorldDescription{});
  run.Run(ticks);
  return run;
}

class UnderTableScenario : public testing::Test {
 protected:
  ScenarioRun run_ = LoadAndRun(LoadScenario(SourceFolder() + "/worlds/scenarios/under_table.json"), 120);
};

TEST_F(UnderTableScenario, ALowRobotDrivesUnderTheTopBetweenTheLegs) {
  EXPECT_FALSE(run_.EverStalled("low"));
  EXPECT_GT(run_["low"].X_WR.x, 1.0);
}

TEST_F(UnderTableScenario, AMastTallerThanTheTableStallsAtItsEdge) {
  EXPECT_TRUE(run_["tall"].stalled);
  // The mast's front is 3 cm behind the robot's middle, the table's edge at -0.8 m.
  EXPECT_NEAR(run_["tall"].X_WR.x - 0.03, -0.8, kMillimetre);
  EXPECT_EQ(run_.MetWithinOneMillimetre("tall"), "table_tall");
  EXPECT_FALSE(run_.InsideSomething("tall"));
}

TEST_F(UnderTableScenario, ALegStallsTheLowRobotToo) {
  EXPECT_TRUE(run_["leg"].stalled);
  EXPECT_NEAR(run_["leg"].X_WR.x + 0.18, -0.8, kMillimetre);
  EXPECT_EQ(run_.MetWithinOneMillimetre("leg"), "table_leg");
  EXPECT_FALSE(run_.InsideSomething("leg"));
}

TEST_F(UnderTableScenario, RobotsThatCollideHeadOnStallAtContact) {
  for (const std::string speed : {"slow", "fast"}) {
    const std::string east = speed + "_east";
    const std::string west = speed + "_west";
    EXPECT_TRUE(run_[east].stalled) << east;
    EXPECT_TRUE(run_[west].stalled) << west;
    EXPECT_NEAR(run_[west].X_WR.x - run_[east].X_WR.x, 0.36, kMillimetre) << speed;
    EXPECT_EQ(run_.MetWithinOneMillimetre(east), west);
    EXPECT_EQ(run_.MetWithinOneMillimetre(west), east);
    EXPECT_FALSE(run_.InsideSomething(east)) << east;
    EXPECT_FALSE(run_.InsideSomething(west)) << west;
  }
}

// The lab. Its table at (1.465, 1.525) is 1.54 m x 0.8 m; the top is 69.5 cm above the floor, and braces between the
// legs, 16 cm above it, close all sides but the one in front (y = 1.125).
class LabTable : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(StageWorldsFolder() + "/uoa_robotics_lab.world")) {
      GTEST_SKIP() << "no Stage worlds in " << StageWorldsFolder() << "; set TROUPE_STAGE_WORLDS";
    }
  }

  // Drives a robot of `model` from (x, 0.3) towards the table's front for `seconds`, then stops it.
  static ScenarioRun DriveNorth(const std::string& model, double x, double seconds, int ticks) {
    const std::string text = R"({"world": ")" + StageWorldsFolder() + R"(/uoa_robotics_lab.world",
      "include": ["robots.inc"],
      "robots": [{"name": "guest", "pose": [)" +
                             std::to_string(x) + R"(, 0.3, 90], )" + model + R"(,
        "controller": {"name": "script", "parameters": {
          "commands": [{"at": 0, "vx": 0.5}, {"at": )" +
                             std::to_string(seconds) + R"(}]}}}]})";
    return LoadAndRun(LoadScenarioText(text, SourceFolder() + "/worlds/include/lab.json"), ticks);
  }

  // The place of the obstacle on the guest's path.
  static Pose MetPose(ScenarioRun& run) {
    const std::string name = run.MetWithinOneMillimetre("guest");
    const WorldDescription& world = run.scene().world();
    for (const ModelDescription& model : world.models) {
      if (model.name == name) return model.X_PM;
    }
    ADD_FAILURE() << "the guest has no contact within 1 mm";
    return {};
  }
};

TEST_F(LabTable, AScoutDrivesUnderTheTopBetweenTheLegs) {
  ScenarioRun run = DriveNorth(R"("model": "scout")", 1.3, 2.4, 60);
  EXPECT_FALSE(run.EverStalled("guest"));
  EXPECT_GT(run["guest"].X_WR.y, 1.125 + 0.18);  // wholly under the top
  EXPECT_LT(run["guest"].X_WR.y, 1.925 - 0.18);
  EXPECT_FALSE(run.InsideSomething("guest"));
}

TEST_F(LabTable, ARobotLowerThanTheBracesDrivesThroughToTheOtherSide) {
  ScenarioRun run = DriveNorth(R"("model": "position", "properties": {"size": [0.4, 0.35, 0.15]})", 1.3, 6.4, 80);
  EXPECT_FALSE(run.EverStalled("guest"));
  EXPECT_GT(run["guest"].X_WR.y, 3.0);
}

TEST_F(LabTable, AMastTallerThanTheTableStallsAtItsEdge) {
  ScenarioRun run = DriveNorth(R"("model": "scout_with_mast")", 1.3, 100.0, 60);
  EXPECT_TRUE(run["guest"].stalled);
  EXPECT_NEAR(run["guest"].X_WR.y - 0.03, 1.125, kMillimetre);
  EXPECT_NEAR(MetPose(run).x, 1.465, 1e-9);
  EXPECT_NEAR(MetPose(run).y, 1.525, 1e-9);
  EXPECT_FALSE(run.InsideSomething("guest"));
}

TEST_F(LabTable, ALegStallsTheScout) {
  ScenarioRun run = DriveNorth(R"("model": "scout")", 0.74, 100.0, 60);
  EXPECT_TRUE(run["guest"].stalled);
  EXPECT_NEAR(run["guest"].X_WR.y + 0.18, 1.125, kMillimetre);
  EXPECT_NEAR(MetPose(run).x, 1.465, 1e-9);
  EXPECT_FALSE(run.InsideSomething("guest"));
}

// Small worlds of people, beside those of Stage.
class Cases : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = StageWorldsFolder() + "/../cases/";
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "no folder " << folder_;
  }
  std::string folder_;
};

TEST_F(Cases, AFloorplanWithoutHeightIsHitByARobotOnTheGround) {
  Result<LoadedWorld> loaded = LoadWorld(folder_ + "flat_floorplan.world");
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  EXPECT_TRUE(std::ranges::any_of(loaded.value().warnings, [](const Warning& warning) {
    return warning.message.find("'plan' has no height") != std::string::npos;
  }));
  ScenarioRun run(std::move(loaded).value().world);
  bool touched = false;
  for (int tick = 0; tick < 1000; ++tick) {
    run.Run(1);
    ASSERT_FALSE(run.InsideSomething("r0")) << tick;
    touched = touched || (run["r0"].stalled && run.MetWithinOneMillimetre("r0") == "plan");
  }
  EXPECT_TRUE(touched);
}

TEST_F(Cases, ABlobfinderSeesAHalfCircle) {
  const Result<LoadedWorld> loaded = LoadWorld(folder_ + "blobfinder_fov180.world");
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  EXPECT_TRUE(loaded.value().warnings.empty());
}

}  // namespace
}  // namespace troupe
