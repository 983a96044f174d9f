#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/gripper_world.h"
#include "tests/unit/sensing/measure.h"

namespace troupe {
namespace {

using ::testing::DoubleEq;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

// A robot at the origin that looks along x with one ray at a height of 0.3 m.
class RangerTest : public ::testing::Test {
 protected:
  RangerTest() {
    robot_ = world_.AddRobot("r0", {});
    world_.AddRanger(robot_, {0.0, 0.0, 0.3, 0.0}, {OneRay()});
  }
  RaySensorDescription& sensor() { return RaySensors(world_.robot(robot_).sensors[0])[0]; }
  RangeScan Scan() { return Measure(world_.world(), robot_).scans[0]; }
  double Range() { return Scan().ranges[0]; }

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(RangerTest, ReadsTheExactDistance) {
  world_.AddBox("box", 3.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  const RangeScan scan = Scan();
  EXPECT_THAT(scan.ranges, ElementsAre(DoubleEq(2.5)));
  EXPECT_THAT(scan.intensities, ElementsAre(1.0));
}

TEST_F(RangerTest, AMissReadsTheMaximumWithoutIntensity) {
  world_.AddBox("box", 6.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  const RangeScan scan = Scan();
  EXPECT_THAT(scan.ranges, ElementsAre(5.0));
  EXPECT_THAT(scan.intensities, ElementsAre(0.0));
}

TEST_F(RangerTest, AHitBelowTheMinimumReadsTheMinimum) {
  sensor().range.min = 1.0;
  world_.AddBox("box", 1.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  const RangeScan scan = Scan();
  EXPECT_THAT(scan.ranges, ElementsAre(1.0));
  EXPECT_THAT(scan.intensities, ElementsAre(1.0));
}

TEST_F(RangerTest, InsideABlockReadsTheMinimum) {
  sensor().range.min = 0.25;
  world_.AddBox("box", 0.0, 0.0, 2.0, 2.0, {0.0, 1.0});
  EXPECT_EQ(Range(), 0.25);
}

TEST_F(RangerTest, LooksOverALowBlock) {
  world_.AddBox("step", 2.0, 0.0, 1.0, 1.0, {0.0, 0.3});  // as high as the ray: a block ends below its top
  world_.AddBox("wall", 4.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  EXPECT_DOUBLE_EQ(Range(), 3.5);
}

TEST_F(RangerTest, LooksUnderATableTop) {
  world_.AddBox("top", 2.0, 0.0, 1.0, 1.0, {0.7, 0.8});
  world_.AddBox("leg", 2.4, 0.0, 0.1, 0.1, {0.0, 0.7});
  EXPECT_DOUBLE_EQ(Range(), 2.35);
}

TEST_F(RangerTest, HeightsOfRobotRangerAndSensorAddUp) {
  world_.world().models[0].X_PM.z = 0.25;
  sensor().X_MS.z = 0.2;  // 0.75 m in all
  world_.AddBox("top", 2.0, 0.0, 1.0, 1.0, {0.7, 0.8});
  world_.AddBox("below", 1.0, 0.0, 1.0, 1.0, {0.0, 0.7});
  EXPECT_DOUBLE_EQ(Range(), 1.5);
}

TEST_F(RangerTest, DoesNotSeeItsOwnRobot) {
  world_.AddPart(robot_, "bumper", {0.5, 0.0, 0.0, 0.0}, 0.2, 1.0, {0.0, 1.0});
  EXPECT_EQ(Range(), 5.0);
}

TEST_F(RangerTest, LooksThroughNegativeRangerReturn) {
  world_.AddBox("glass", 2.0, 0.0, 1.0, 1.0, {0.0, 1.0}).ranger_return = -1.0;
  world_.AddBox("wall", 4.0, 0.0, 1.0, 1.0, {0.0, 1.0}).ranger_return = 0.7;
  const RangeScan scan = Scan();
  EXPECT_THAT(scan.ranges, ElementsAre(DoubleEq(3.5)));
  EXPECT_THAT(scan.intensities, ElementsAre(0.7));
}

TEST_F(RangerTest, SeesRangerReturnZeroWithoutIntensity) {
  world_.AddBox("soot", 2.0, 0.0, 1.0, 1.0, {0.0, 1.0}).ranger_return = 0.0;
  const RangeScan scan = Scan();
  EXPECT_THAT(scan.ranges, ElementsAre(DoubleEq(1.5)));
  EXPECT_THAT(scan.intensities, ElementsAre(0.0));
}

TEST_F(RangerTest, SeesModelsWithoutObstacleReturn) {
  world_.AddBox("picture", 2.0, 0.0, 1.0, 1.0, {0.0, 1.0}).obstacle_return = false;
  EXPECT_DOUBLE_EQ(Range(), 1.5);
}

TEST_F(RangerTest, SeesOtherRobotsWhereTheyAre) {
  const RobotId other = world_.AddRobot("r1", {2.0, 3.0, 0.0, 0.0});
  EXPECT_EQ(Range(), 5.0);
  WorldState state = PlacedState(world_.world());
  state.robots[other.index()].X_WR = {2.0, 0.1, 0.0, 0.0};
  EXPECT_DOUBLE_EQ(Measure(world_.world(), state, robot_).scans[0].ranges[0], 1.8);
  state.robots[other.index()].X_WR = {2.0, 0.0, 0.0, kPi / 4};  // a corner points here
  EXPECT_NEAR(Measure(world_.world(), state, robot_).scans[0].ranges[0], 2.0 - 0.2 * std::sqrt(2.0), 1e-12);
}

TEST_F(RangerTest, MovesAndTurnsWithItsMount) {
  world_.AddBox("wall", 0.0, 4.0, 9.0, 1.0, {0.0, 1.0});  // its face at y = 3.5
  WorldState state = PlacedState(world_.world());
  state.robots[0].X_WR = {1.0, 0.5, 0.0, kPi / 4};
  sensor().X_MS = {0.3, 0.0, 0.0, kPi / 4};
  const double y = 0.5 + 0.3 * std::sqrt(0.5);
  EXPECT_NEAR(Measure(world_.world(), state, robot_).scans[0].ranges[0], 3.5 - y, 1e-12);
}

TEST_F(RangerTest, AFanReadsFromRightToLeft) {
  sensor() = Fan(kPi / 2, 3);
  world_.AddBox("right", 2.0, -2.0, 1.0, 1.0, {0.0, 1.0});
  world_.AddBox("ahead", 3.5, 0.0, 1.0, 1.0, {0.0, 1.0});
  EXPECT_THAT(Scan().ranges,
              ElementsAre(DoubleNear(1.5 * std::sqrt(2.0), 1e-12), DoubleNear(3.0, 1e-12), DoubleEq(5.0)));
}

// The geometry of a reading alone gives the origin and the bearing of each ray, and with the state the hits.
TEST_F(RangerTest, AReadingCarriesItsGeometry) {
  world_.AddRanger(robot_, {0.1, -0.2, 0.3, 0.5}, {Fan(1.0, 41, 8.0)});
  RaySensors(world_.robot(robot_).sensors[1])[0].X_MS = {0.05, 0.02, 0.1, -0.25};
  RaySensors(world_.robot(robot_).sensors[1])[0].range.min = 0.1;
  world_.AddBox("wall", 4.0, 0.0, 1.0, 40.0, {0.0, 1.0});  // its face at x = 3.5
  WorldState state = PlacedState(world_.world());
  state.robots[0].X_WR = {0.5, 1.0, 0.0, 0.125};
  const RangeScan scan = Measure(world_.world(), state, robot_, 1).scans[0];
  EXPECT_EQ(scan.fan, (RayFan{1.0, 41}));
  EXPECT_EQ(scan.X_RS, (Pose{0.1, -0.2, 0.3, 0.5} * Pose{0.05, 0.02, 0.1, -0.25}));
  EXPECT_EQ(scan.limits, (Interval{0.1, 8.0}));
  const Pose X_WS = state.robots[0].X_WR * scan.X_RS;
  for (std::size_t i = 0; i < scan.fan.count; ++i) {
    ASSERT_LT(scan.ranges[i], 8.0) << i;
    const double bearing = X_WS.heading + scan.fan.angle_min() + static_cast<double>(i) * scan.fan.angle_increment();
    EXPECT_NEAR(X_WS.x + scan.ranges[i] * std::cos(bearing), 3.5, 1e-12) << i;
  }
}

TEST_F(RangerTest, AReadingHasThePoseOfARangerOnALift) {
  test::GripperWorld world;
  const test::GripperRobot robot = world.AddGripperRobot({1.0, 2.0, 0.0, 0.5});
  SensorDescription ranger;
  ranger.model = robot.carriage;
  RaySensors(ranger) = {OneRay()};
  RaySensors(ranger)[0].X_MS = {0.05, 0.0, 0.1, 0.25};
  world.world.robots[0].sensors = {ranger};
  WorldState state = PlacedState(world.world);
  state.joints[robot.lift.index()].position = 0.5;
  const Pose X_RS = Measure(world.world, state, robot.robot).scans[0].X_RS;
  EXPECT_EQ(X_RS, (Pose{0.25, 0.0, 0.5, 0.0} * Pose{0.05, 0.0, 0.1, 0.25}));
}

// A ranger with a name and ray sensors of three and one rays.
class RangerJsonTest : public ::testing::Test {
 protected:
  RangerJsonTest() {
    robot_ = world_.AddRobot("r0", {});
    world_.AddRanger(robot_, {}, {Fan(1.0, 3), OneRay()});
    reading_ = {.tick = 12, .content = RangerReading{{{.ranges = {0.1, 5.0, 1.0 / 3.0}}, {.ranges = {2.0}}, {}}}};
  }
  std::string Lines() {
    const Scene scene(world_.world());
    return MakeSensors(scene, robot_).at(0)->JsonLines(scene.world(), reading_);
  }

  SmallWorld world_;
  RobotId robot_;
  SensorReading reading_;
};

TEST_F(RangerJsonTest, HasALineForEachRaySensor) {
  EXPECT_EQ(Lines(),
            "{\"tick\":12,\"robot\":\"r0\",\"sensor\":\"ranger:0.0\",\"ranges\":[0.1,5,0.3333333333333333]}\n"
            "{\"tick\":12,\"robot\":\"r0\",\"sensor\":\"ranger:0.1\",\"ranges\":[2]}\n"
            "{\"tick\":12,\"robot\":\"r0\",\"sensor\":\"ranger:0.2\",\"ranges\":[]}\n");
}

TEST_F(RangerJsonTest, NamesOfAnyBytesAreJson) {
  world_.robot(robot_).name = "a \"b\"\n\xff";
  std::get<RangerReading>(reading_.content).scans.resize(1);
  EXPECT_TRUE(nlohmann::json::accept(Lines())) << Lines();
}

TEST_F(RangerTest, EachSensorOfARangerHasItsScan) {
  RaySensorDescription back = OneRay(2.0);
  back.X_MS = {-0.1, 0.0, 0.0, kPi};
  RaySensors(world_.robot(robot_).sensors[0]).push_back(back);
  world_.AddBox("wall", 3.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  world_.AddBox("behind", -1.5, 0.0, 1.0, 1.0, {0.0, 1.0});
  const RangerReading reading = Measure(world_.world(), robot_);
  ASSERT_EQ(reading.scans.size(), 2u);
  EXPECT_DOUBLE_EQ(reading.scans[0].ranges[0], 2.5);
  EXPECT_NEAR(reading.scans[1].ranges[0], 0.9, 1e-12);
}

}  // namespace
}  // namespace troupe
