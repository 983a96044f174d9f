// The scenarios with grippers end as they should: worlds/scenarios/stacking.json, marina.json, lab.json, relay.json.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

#include "common/model/states.h"
#include "tests/worldfile/scenario_run.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

class ManipulationScenario : public testing::Test {
 protected:
  // Runs a scenario of this source tree to its end, with ticks longer by a factor.
  void RunScenario(const std::string& name, double longer = 1.0) {
    const char* source = std::getenv("TROUPE_SOURCE_DIR");
    Result<LoadedWorld> loaded =
        LoadWorld(std::string(source != nullptr ? source : ".") + "/worlds/scenarios/" + name + ".json");
    ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
    for (const Warning& warning : loaded.value().warnings) ADD_FAILURE() << warning.ToString();
    ASSERT_TRUE(loaded.value().settings.ticks);
    WorldDescription& world = loaded.value().world;
    world.interval_ns = static_cast<std::int64_t>(static_cast<double>(world.interval_ns) * longer);
    run_.emplace(std::move(world));
    run_->Run(static_cast<int>(static_cast<double>(*loaded.value().settings.ticks) / longer));
  }

  const WorldDescription& world() const { return run_->scene().world(); }
  const ObjectState& Object(const std::string& name) const {
    for (std::size_t i = 0; i < world().objects.size(); ++i) {
      if (world().model(world().objects[i]).name == name) return run_->state().objects[i];
    }
    ADD_FAILURE() << "no object " << name;
    return run_->state().objects[0];
  }
  std::string NameOf(const std::optional<ModelId>& model) const { return model ? world().model(*model).name : ""; }
  int CountEvents(EventType type) const {
    int count = 0;
    for (const Event& event : run_->events()) count += event.type == type;
    return count;
  }
  // The obstacle that stopped the robot first.
  std::string OtherOfFirstStall(const std::string& robot) const {
    for (const Event& event : run_->events()) {
      if (event.type == EventType::kStallBegan && event.robot == run_->Find(robot)) return NameOf(event.other);
    }
    return "";
  }
  // The events so far, for a test that fails.
  std::string Story() const {
    std::string text;
    for (const Event& event : run_->events()) {
      text += std::to_string(event.tick) + " " + troupe::NameOf(event.type) + " " +
              (event.robot ? world().robot(*event.robot).name : "") + " " + event.detail + " " + NameOf(event.object) +
              " " + NameOf(event.other) + "\n";
    }
    for (std::size_t i = 0; i < world().objects.size(); ++i) {
      const ObjectState& object = run_->state().objects[i];
      text += NameOf(world().objects[i]) + " " + std::to_string(object.X_WO.x) + " " + std::to_string(object.X_WO.y) +
              " " + std::to_string(object.X_WO.z) + " mode " + std::to_string(static_cast<int>(object.mode)) + "\n";
    }
    return text;
  }

  std::optional<ScenarioRun> run_;
};

constexpr double kCentimetre = 0.01;

TEST_F(ManipulationScenario, StackingBuildsATowerAndMovesItElsewhereInReverseOrder) {
  RunScenario("stacking");
  SCOPED_TRACE(Story());
  double height = 0.0;
  std::string below;
  for (const std::string name : {"blue", "green", "red"}) {
    const ObjectState& cube = Object(name);
    EXPECT_EQ(cube.mode, ObjectMode::kResting) << name;
    EXPECT_NEAR(cube.X_WO.x, -1.2, kCentimetre) << name;
    EXPECT_NEAR(cube.X_WO.y, -0.9, kCentimetre) << name;
    EXPECT_EQ(cube.X_WO.z, height) << name;
    EXPECT_EQ(NameOf(cube.support), below) << name;
    height += 0.2;
    below = name;
  }
  EXPECT_EQ(CountEvents(EventType::kGripped), 6);
  EXPECT_EQ(CountEvents(EventType::kReleased), 6);
  EXPECT_EQ(CountEvents(EventType::kUnstable), 0);
  EXPECT_EQ(CountEvents(EventType::kStallBegan), 0);
}

TEST_F(ManipulationScenario, TicksOfHalfAndDoubleLengthBuildTheSameTower) {
  std::map<std::string, Pose> usual;
  for (const double longer : {1.0, 0.5, 2.0}) {
    RunScenario("stacking", longer);
    SCOPED_TRACE(Story());
    double height = 0.0;
    for (const std::string name : {"blue", "green", "red"}) {
      const Pose& pose = usual.emplace(name, Object(name).X_WO).first->second;
      EXPECT_NEAR(Object(name).X_WO.x, pose.x, 1e-3) << name << " " << longer;
      EXPECT_NEAR(Object(name).X_WO.y, pose.y, 1e-3) << name << " " << longer;
      EXPECT_EQ(Object(name).X_WO.z, height) << name << " " << longer;
      EXPECT_EQ(Object(name).mode, ObjectMode::kResting) << name << " " << longer;
      height += 0.2;
    }
  }
}

TEST_F(ManipulationScenario, MarinaBringsTheBoatFromItsBerthToTheWater) {
  RunScenario("marina");
  SCOPED_TRACE(Story());
  const ObjectState& boat = Object("b2");
  EXPECT_EQ(boat.mode, ObjectMode::kResting);
  EXPECT_EQ(boat.X_WO.z, 0.0);
  EXPECT_NEAR(boat.X_WO.x, 7.35, kCentimetre);
  EXPECT_NEAR(boat.X_WO.y, 0.0, kCentimetre);
  EXPECT_EQ(Object("b1").X_WO, (Pose{-5.0, 0.0, 0.6, kPi}));
  EXPECT_EQ(CountEvents(EventType::kGripped), 1);
  EXPECT_EQ(CountEvents(EventType::kStallBegan), 0);
}

TEST_F(ManipulationScenario, LabRobotsTouchObstaclesAtEveryHeight) {
  RunScenario("lab");
  SCOPED_TRACE(Story());
  struct Meeting {
    const char* robot;
    const char* other;
    double x;  // m, its place then
  };
  const Meeting meetings[] = {
      {"body_at_cabinet", "cabinet", -1.3603},   {"laser_at_bench", "bench", 1.9},
      {"mast_at_table", "table3", 1.065},        {"gripper_at_table", "table5", -0.148},
      {"load_at_table", "table2", 1.0980 - 0.5},
  };
  for (const Meeting& meeting : meetings) {
    const RobotState& robot = (*run_)[meeting.robot];
    EXPECT_NEAR(robot.X_WR.x, meeting.x, 0.004) << meeting.robot;
    EXPECT_EQ(OtherOfFirstStall(meeting.robot), meeting.other) << meeting.robot;
  }
}

TEST_F(ManipulationScenario, LabCarrierHasToLowerItsBoxToPassTheTunnels) {
  RunScenario("lab");
  SCOPED_TRACE(Story());
  EXPECT_EQ(OtherOfFirstStall("carrier"), "tunnel0");
  const ObjectState& box = Object("box");
  EXPECT_EQ(box.mode, ObjectMode::kResting);
  EXPECT_NEAR(box.X_WO.x, 0.05, kCentimetre);
  EXPECT_NEAR(box.X_WO.y, 6.8, kCentimetre);
  EXPECT_EQ(box.X_WO.z, 0.0);
  EXPECT_FALSE((*run_)["carrier"].stalled);
}

TEST_F(ManipulationScenario, RelayHandsTheBeamOverAndClearsTheField) {
  RunScenario("relay");
  SCOPED_TRACE(Story());
  const ObjectState& beam = Object("beam");
  EXPECT_EQ(beam.mode, ObjectMode::kResting);
  EXPECT_NEAR(beam.X_WO.x, 2.78, kCentimetre);
  EXPECT_EQ(beam.X_WO.z, 0.0);
  for (int lane = 0; lane < 10; ++lane) {
    double height = 0.0;
    std::string below;
    for (int level = 0; level < 4; ++level) {
      const std::string name = "cube" + std::to_string(lane) + std::to_string(level);
      const ObjectState& cube = Object(name);
      EXPECT_EQ(cube.mode, ObjectMode::kResting) << name;
      EXPECT_NEAR(cube.X_WO.x, -1.6, kCentimetre) << name;
      EXPECT_NEAR(cube.X_WO.y, (lane - 4.5) * 1.3, kCentimetre) << name;
      EXPECT_EQ(cube.X_WO.z, height) << name;
      EXPECT_EQ(NameOf(cube.support), below) << name;
      height += 0.2;
      below = name;
    }
  }
  EXPECT_EQ(CountEvents(EventType::kGripped), 42);
  EXPECT_EQ(CountEvents(EventType::kUnstable), 0);
}

}  // namespace
}  // namespace troupe
