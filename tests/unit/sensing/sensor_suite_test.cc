#include "common/sensing/sensor_suite.h"

#include <gtest/gtest.h>

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
  static double Range(const SensorReading& reading) { return reading.ranger()->scans[0].ranges[0]; }

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

TEST_F(SensorSuiteTest, ReadingsEqualDirectMeasurements) {
  sensors_->Subscribe(0);
  const SensedWorld world = At(0.3);
  sensors_->Update(world, 4);
  const SensorReading direct = sensors_->sensor(0).Measure(world, 4);
  EXPECT_EQ(sensors_->readings()[0], direct);
  EXPECT_EQ(sensors_->Measure(0, world, 4), direct);
}

}  // namespace
}  // namespace troupe
