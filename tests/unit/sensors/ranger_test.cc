#include "robot-agent/sensors/ranger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/sensors/measure.h"

namespace troupe {
namespace {

using ::testing::DoubleEq;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

TEST(BearingsTest, SpanTheFanWithBothEnds) {
  EXPECT_THAT(Bearings(Fan(2.0, 5)), ElementsAre(-1.0, -0.5, 0.0, 0.5, 1.0));
  EXPECT_THAT(Bearings(Fan(2.0, 2)), ElementsAre(-1.0, 1.0));
}

TEST(BearingsTest, LeftAndRightAreMirrorImages) {
  const std::vector<double> bearings = Bearings(Fan(4.7, 361));
  for (std::size_t i = 0; i < bearings.size(); ++i) EXPECT_EQ(bearings[i], -bearings[bearings.size() - 1 - i]);
}

TEST(BearingsTest, ASingleRayLooksStraightAhead) {
  RaySensorDescription sensor = OneRay();
  sensor.fov = 1.0;
  EXPECT_THAT(Bearings(sensor), ElementsAre(0.0));
}

// A robot at the origin that looks along x with one ray at a height of 0.3 m.
class RangerTest : public ::testing::Test {
 protected:
  RangerTest() {
    robot_ = world_.AddRobot("r0", {});
    world_.AddRanger(robot_, {0.0, 0.0, 0.3, 0.0}, {OneRay()});
  }
  RaySensorDescription& sensor() { return world_.robot(robot_).rangers[0].sensors[0]; }
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

TEST_F(RangerTest, WhatIsNearerThanTheMinimumReadsTheMinimum) {
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

TEST_F(RangerTest, SeesWhatNobodyCollidesWith) {
  world_.AddBox("picture", 2.0, 0.0, 1.0, 1.0, {0.0, 1.0}).obstacle_return = false;
  EXPECT_DOUBLE_EQ(Range(), 1.5);
}

TEST_F(RangerTest, SeesOtherRobotsWhereTheyAre) {
  const RobotId other = world_.AddRobot("r1", {2.0, 3.0, 0.0, 0.0});
  EXPECT_EQ(Range(), 5.0);
  WorldState state = InitialState(world_.world());
  state.robots[other.index()].X_WR = {2.0, 0.1, 0.0, 0.0};
  EXPECT_DOUBLE_EQ(Measure(world_.world(), state, robot_).scans[0].ranges[0], 1.8);
  state.robots[other.index()].X_WR = {2.0, 0.0, 0.0, kPi / 4};  // a corner points here
  EXPECT_NEAR(Measure(world_.world(), state, robot_).scans[0].ranges[0], 2.0 - 0.2 * std::sqrt(2.0), 1e-12);
}

TEST_F(RangerTest, MovesAndTurnsWithItsMount) {
  world_.AddBox("wall", 0.0, 4.0, 9.0, 1.0, {0.0, 1.0});  // its face at y = 3.5
  WorldState state = InitialState(world_.world());
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

TEST_F(RangerTest, EachSensorOfARangerHasItsScan) {
  RaySensorDescription back = OneRay(2.0);
  back.X_MS = {-0.1, 0.0, 0.0, kPi};
  world_.robot(robot_).rangers[0].sensors.push_back(back);
  world_.AddBox("wall", 3.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  world_.AddBox("behind", -1.5, 0.0, 1.0, 1.0, {0.0, 1.0});
  const RangerReading reading = Measure(world_.world(), robot_);
  ASSERT_EQ(reading.scans.size(), 2u);
  EXPECT_DOUBLE_EQ(reading.scans[0].ranges[0], 2.5);
  EXPECT_NEAR(reading.scans[1].ranges[0], 0.9, 1e-12);
}

}  // namespace
}  // namespace troupe
