// Stage's own gripper on the stacking script that Stage cannot execute: worlds/scenarios/stage_stacking.json.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/worldfile/scenario_run.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

TEST(StageStacking, StacksTheBoxInThePoseInWhichItWasGripped) {
  const char* source = std::getenv("TROUPE_SOURCE_DIR");
  Result<LoadedWorld> loaded =
      LoadWorld(std::string(source != nullptr ? source : ".") + "/worlds/scenarios/stage_stacking.json");
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  ScenarioRun run(std::move(loaded.value().world));
  const ObjectId box(0);
  const auto state = [&]() -> const ObjectState& { return run.state().objects[box.index()]; };
  const Pose start = state().X_WO;
  run.Run(40);
  EXPECT_EQ(state().mode, ObjectMode::kHeld);
  EXPECT_EQ(state().X_WO, start) << "gripped where it is, as it is turned";
  run.Run(40);
  EXPECT_NEAR(state().X_WO.z, 0.18, 1e-9) << "lifted by the part of the gripper's height above its paddles";
  run.Run(130);
  EXPECT_EQ(state().mode, ObjectMode::kResting);
  EXPECT_EQ(state().X_WO.z, 0.1);
  EXPECT_NEAR(state().X_WO.x, 1.41, 1e-9);
  EXPECT_EQ(state().support, run.scene().world().objects[1]);
  EXPECT_LT(run["r"].X_WR.x, 0.0) << "the robot has backed off";
}

}  // namespace
}  // namespace troupe
