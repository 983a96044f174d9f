#include "common/sensing/sensor_suite.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/gripper_world.h"
#include "tests/support/small_world.h"
#include "troupe/world_state.h"

namespace troupe {
namespace {

// A robot 2 m in front of a wall, with a ranger of each tick and one of each third tick.
class SensorSuiteTest : public ::testing::Test {
 protected:
  SensorSuiteTest() {
    robot_ = world_.AddRobot("r0", {});
    world_.AddBox("wall", 2.5, 0.0, 1.0, 5.0, {0.0, 1.0});
    world_.AddRanger(robot_, {0.0, 0.0, 0.3, 0.0}, {OneRay()});
    world_.AddRanger(robot_, {0.0, 0.0, 0.3, 0.0}, {OneRay()});
    world_.robot(robot_).sensors[1].period_ticks = 3;
    scene_ = std::make_unique<Scene>(world_.world());
    bodies_ = std::make_unique<BodyIndex>(*scene_);
    sensors_ = std::make_unique<SensorSuite>(*scene_, robot_);
    state_ = PlacedState(world_.world());
  }
  SensedWorld At(double x) {
    state_.robots[0].X_WR.x = x;
    bodies_->Assign(state_);
    return {*scene_, *bodies_};
  }
  static double Range(const SensorReading& reading) { return reading.ranger()->ranges[0]; }

  SmallWorld world_;
  RobotId robot_;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<BodyIndex> bodies_;
  std::unique_ptr<SensorSuite> sensors_;
  WorldState state_;
};

TEST_F(SensorSuiteTest, MeasuresSubscribedSensorsOnly) {
  sensors_->Subscribe(1);
  sensors_->Update(At(0.0), 0);
  ASSERT_EQ(sensors_->readings().size(), 2u);
  EXPECT_TRUE(sensors_->readings()[0].empty());
  EXPECT_EQ(Range(sensors_->readings()[1]), 2.0);
}

TEST_F(SensorSuiteTest, ASensorKeepsItsReadingUntilItIsDue) {
  sensors_->Subscribe(0);
  sensors_->Subscribe(1);
  for (Tick tick = 0; tick < 7; ++tick) {
    sensors_->Update(At(0.1 * static_cast<double>(tick)), tick);
    EXPECT_EQ(sensors_->readings()[0].tick, tick);
    EXPECT_EQ(sensors_->readings()[1].tick, tick - tick % 3);
  }
  EXPECT_NEAR(Range(sensors_->readings()[1]), 1.4, 1e-12);
}

TEST_F(SensorSuiteTest, MeasuresAnySensorWithoutEffectOnTheReadings) {
  sensors_->Subscribe(1);
  sensors_->Update(At(0.0), 0);
  const SensedWorld later = At(1.0);
  sensors_->Update(later, 1);
  EXPECT_EQ(Range(sensors_->Measure(0, later, 1)), 1.0);
  EXPECT_EQ(Range(sensors_->Measure(1, later, 1)), 1.0);  // between its periods
  EXPECT_TRUE(sensors_->readings()[0].empty());
  EXPECT_EQ(Range(sensors_->readings()[1]), 2.0);
}

TEST_F(SensorSuiteTest, MeasuresUnlikeSensorsInTurn) {
  world_.AddRanger(robot_, {0.1, 0.2, 0.3, 0.5}, {OneRay(), OneRay()});
  const Scene scene(world_.world());
  BodyIndex bodies(scene);
  bodies.Assign(state_);
  SensorSuite sensors(scene, robot_);
  for (const std::size_t sensor : {0, 2, 2, 0}) {
    EXPECT_EQ(sensors.Measure(sensor, {scene, bodies}, 1), sensors.sensor(sensor).Measure({scene, bodies}, 1));
  }
}

TEST_F(SensorSuiteTest, ReadingsEqualDirectMeasurements) {
  sensors_->Subscribe(0);
  const SensedWorld world = At(0.3);
  sensors_->Update(world, 4);
  const SensorReading direct = sensors_->sensor(0).Measure(world, 4);
  EXPECT_EQ(sensors_->readings()[0], direct);
  EXPECT_EQ(sensors_->Measure(0, world, 4), direct);
}

TEST(SensorRegistryTest, FindsEachKindByItsName) {
  std::set<std::string_view> names;
  for (const SensorKind& kind : SensorKinds()) {
    EXPECT_EQ(FindSensorKind(kind.type), &kind);
    EXPECT_TRUE(names.insert(kind.type).second) << kind.type;
  }
  EXPECT_EQ(FindSensorKind("thermometer"), nullptr);
  EXPECT_EQ(FindSensorKind(""), nullptr);
}

TEST(SensorRegistryTest, HasAKindForEachAlternativeOfADescription) {
  EXPECT_EQ(SensorKinds().size(), std::variant_size_v<SensorParameters>);
  EXPECT_NE(FindSensorKind(TypeOf(RangerParameters())), nullptr);
  EXPECT_NE(FindSensorKind(TypeOf(BreakBeamParameters())), nullptr);
}

TEST(SensorRegistryTest, ARobotWithoutSensorsHasNone) {
  SmallWorld world;
  const RobotId robot = world.AddRobot("r0", {});
  EXPECT_TRUE(MakeSensors(Scene(world.world()), robot).empty());
}

TEST(SensorRegistryTest, DescribedSensorsPrecedeTheBeamsOfGrippers) {
  test::GripperWorld world;
  const test::GripperRobot first = world.AddGripperRobot({});
  const test::GripperRobot second = world.AddGripperRobot({4.0, 0.0, 0.0, 0.0});
  SensorDescription ranger{.name = "ranger:0", .model = world.world.robots[0].root};
  RaySensors(ranger) = {OneRay()};
  world.world.robots[0].sensors = {ranger, ranger};
  world.world.grippers[0].beams.resize(2);
  const Scene scene(world.world);
  const std::vector<std::unique_ptr<const Sensor>> sensors = MakeSensors(scene, first.robot);
  ASSERT_EQ(sensors.size(), 3u);
  const char* const types[] = {"ranger", "ranger", "break_beam"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sensors[i]->index(), i);
    EXPECT_EQ(sensors[i]->robot(), first.robot);
    EXPECT_EQ(TypeOf(sensors[i]->description().parameters), types[i]);
  }
  EXPECT_EQ(sensors[2]->description().name, world.world.grippers[0].name + ".beams");
  EXPECT_EQ(sensors[2]->description().model, world.world.grippers[0].model);
  EXPECT_TRUE(MakeSensors(scene, second.robot).empty());
}

}  // namespace
}  // namespace troupe
