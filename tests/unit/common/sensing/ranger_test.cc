#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/gripper_world.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "tests/unit/common/sensing/measure.h"
#include "troupe/sensor.h"

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
  RangeScan Scan() { return Measure(world_.world(), robot_).scan(0); }
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
  EXPECT_DOUBLE_EQ(Measure(world_.world(), state, robot_).scan(0).ranges[0], 1.8);
  state.robots[other.index()].X_WR = {2.0, 0.0, 0.0, kPi / 4};  // a corner points here
  EXPECT_NEAR(Measure(world_.world(), state, robot_).scan(0).ranges[0], 2.0 - 0.2 * std::sqrt(2.0), 1e-12);
}

TEST_F(RangerTest, MovesAndTurnsWithItsMount) {
  world_.AddBox("wall", 0.0, 4.0, 9.0, 1.0, {0.0, 1.0});  // its face at y = 3.5
  WorldState state = PlacedState(world_.world());
  state.robots[0].X_WR = {1.0, 0.5, 0.0, kPi / 4};
  sensor().X_MS = {0.3, 0.0, 0.0, kPi / 4};
  const double y = 0.5 + 0.3 * std::sqrt(0.5);
  EXPECT_NEAR(Measure(world_.world(), state, robot_).scan(0).ranges[0], 3.5 - y, 1e-12);
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
  const RangeScan scan = Measure(world_.world(), state, robot_, 1).scan(0);
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
  const Pose X_RS = Measure(world.world, state, robot.robot).scan(0).X_RS;
  EXPECT_EQ(X_RS, (Pose{0.25, 0.0, 0.5, 0.0} * Pose{0.05, 0.0, 0.1, 0.25}));
}

// A ranger with a name and ray sensors of three and one rays.
class RangerJsonTest : public ::testing::Test {
 protected:
  RangerJsonTest() {
    robot_ = world_.AddRobot("r0", {});
    world_.AddRanger(robot_, {}, {Fan(1.0, 3), OneRay()});
    const std::vector<double> ranges = {0.1, 5.0, 1.0 / 3.0, 2.0};
    reading_ = {.tick = 12, .content = RangerReading{ranges, ranges, {{.fan = {1.0, 3}}, {}, {.fan = {1.0, 0}}}}};
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
  std::get<RangerReading>(reading_.content).geometry.Change().resize(1);
  EXPECT_TRUE(nlohmann::json::accept(Lines())) << Lines();
}

TEST_F(RangerTest, EachSensorOfARangerHasItsScan) {
  RaySensorDescription back = OneRay(2.0);
  back.X_MS = {-0.1, 0.0, 0.0, kPi};
  RaySensors(world_.robot(robot_).sensors[0]).push_back(back);
  world_.AddBox("wall", 3.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  world_.AddBox("behind", -1.5, 0.0, 1.0, 1.0, {0.0, 1.0});
  const RangerReading reading = Measure(world_.world(), robot_);
  ASSERT_EQ(reading.geometry->size(), 2u);
  EXPECT_DOUBLE_EQ(reading.scan(0).ranges[0], 2.5);
  EXPECT_NEAR(reading.scan(1).ranges[0], 0.9, 1e-12);
}

using ::testing::Each;

// A robot before a wall 2 m away that is wide enough for a narrow fan of many rays.
class RangerNoiseTest : public ::testing::Test {
 protected:
  RangerNoiseTest() {
    robot_ = world_.AddRobot("r0", {});
    world_.AddRanger(robot_, {0.0, 0.0, 0.3, 0.0}, {Fan(1e-7, 2000)});
    world_.AddBox("wall", 2.5, 0.0, 1.0, 5.0, {0.0, 1.0});
  }
  RaySensorDescription& sensor() { return RaySensors(world_.robot(robot_).sensors[0])[0]; }
  std::vector<double> Ranges(Tick tick = 0) {
    WorldState state = PlacedState(world_.world());
    state.tick = tick;
    return Measure(world_.world(), state, robot_).scan(0).ranges;
  }

  SmallWorld world_;
  RobotId robot_;
};

TEST_F(RangerNoiseTest, ConstantNoiseHasTheVarianceAsked) {
  sensor().noise_variance = 0.01;
  double sum = 0.0;
  double squares = 0.0;
  for (double range : Ranges()) {
    sum += range - 2.0;
    squares += (range - 2.0) * (range - 2.0);
  }
  EXPECT_NEAR(sum / 2000, 0.0, 0.01);
  EXPECT_NEAR(squares / 2000, 0.01, 0.001);
}

TEST_F(RangerNoiseTest, ProportionalNoiseIsUniformWithinItsPart) {
  sensor().noise_proportional = 0.1;
  const std::vector<double> ranges = Ranges();
  const auto [least, most] = std::minmax_element(ranges.begin(), ranges.end());
  EXPECT_GE(*least, 1.8);
  EXPECT_LT(*least, 1.81);
  EXPECT_LE(*most, 2.2);
  EXPECT_GT(*most, 2.19);
}

TEST_F(RangerNoiseTest, StaysWithinTheSensorsRange) {
  sensor().noise_variance = 4.0;
  sensor().range = {1.5, 2.5};
  const std::vector<double> ranges = Ranges();
  EXPECT_EQ(*std::min_element(ranges.begin(), ranges.end()), 1.5);
  EXPECT_EQ(*std::max_element(ranges.begin(), ranges.end()), 2.5);
}

TEST_F(RangerNoiseTest, AMissHasNoNoise) {
  sensor().noise_variance = 0.01;
  sensor().noise_proportional = 0.1;
  sensor().range.max = 1.5;
  EXPECT_THAT(Ranges(), Each(1.5));
}

TEST_F(RangerNoiseTest, AngleNoiseTurnsRaysByAtMostHalfAStep) {
  sensor() = Fan(1.0, 11);
  sensor().noise_angle = 1.0;
  const std::vector<double> noisy = Ranges();
  bool any_differs = false;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    const double bearing = std::acos(2.0 / noisy[i]);  // the face of the wall is at x = 2
    const double exact = std::abs(-0.5 + 0.1 * static_cast<double>(i));
    EXPECT_LE(std::abs(bearing - exact), 0.05 + 1e-9) << i;
    any_differs = any_differs || std::abs(bearing - exact) > 1e-3;
  }
  EXPECT_TRUE(any_differs);
}

TEST_F(RangerNoiseTest, DependsOnSeedTickAndSensorOnly) {
  sensor().noise_variance = 0.01;
  const std::vector<double> first = Ranges(7);
  EXPECT_EQ(Ranges(7), first);
  EXPECT_NE(Ranges(8), first);
  world_.world().seed = 2;
  EXPECT_NE(Ranges(7), first);
  world_.world().seed = 1;
  world_.AddRobot("r1", {0.0, -2.0, 0.0, 0.0});
  EXPECT_EQ(Ranges(7), first);  // for any number of other robots
}

TEST_F(RangerNoiseTest, SensorsOfARangerDifferFromEachOther) {
  sensor().noise_variance = 0.01;
  const RaySensorDescription same = sensor();
  RaySensors(world_.robot(robot_).sensors[0]).push_back(same);
  const RangerReading reading = Measure(world_.world(), robot_);
  EXPECT_NE(reading.scan(0).ranges, reading.scan(1).ranges);
}

constexpr double kAngles[] = {0.0, 0.1, 1.0, 1.0 / 3.0, 3.14159265358979323846, 4.7, 6.283185307179586};
constexpr std::size_t kCounts[] = {1, 2, 3, 5, 16, 91, 180, 181, 361, 1080, 4096};

template <typename Check>
void ForAllFans(Check check) {
  for (const double fov : kAngles) {
    for (const std::size_t count : kCounts) {
      SCOPED_TRACE(std::to_string(fov) + " rad, " + std::to_string(count) + " rays");
      check(RayFan{fov, count});
    }
  }
}

TEST(RayFanTest, SpansTheFieldOfViewWithBothEnds) {
  const RayFan fan{2.0, 5};
  const double bearings[] = {-1.0, -0.5, 0.0, 0.5, 1.0};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(fan.Bearing(i), bearings[i]);
}

TEST(RayFanTest, TheEndsAreExact) {
  ForAllFans([](const RayFan& fan) {
    const double half = fan.count > 1 ? 0.5 * fan.fov : 0.0;
    EXPECT_EQ(fan.angle_min(), -half);
    EXPECT_EQ(fan.angle_max(), half);
    EXPECT_EQ(fan.Bearing(0), fan.angle_min());
    EXPECT_EQ(fan.Bearing(fan.count - 1), fan.angle_max());
  });
}

TEST(RayFanTest, LeftAndRightAreMirrorImages) {
  ForAllFans([](const RayFan& fan) {
    for (std::size_t i = 0; i < fan.count; ++i) EXPECT_EQ(fan.Bearing(i), -fan.Bearing(fan.count - 1 - i));
  });
}

TEST(RayFanTest, MinimumAndIncrementReproduceEachBearing) {
  ForAllFans([](const RayFan& fan) {
    for (std::size_t i = 0; i < fan.count; ++i) {
      EXPECT_NEAR(fan.angle_min() + static_cast<double>(i) * fan.angle_increment(), fan.Bearing(i), 1e-12);
    }
  });
}

TEST(RayFanTest, ASingleRayPointsStraightAhead) {
  const RayFan fan{1.0, 1};
  EXPECT_EQ(fan.Bearing(0), 0.0);
  EXPECT_EQ(fan.angle_min(), 0.0);
  EXPECT_EQ(fan.angle_increment(), 0.0);
}

}  // namespace

}  // namespace troupe

namespace troupe::test {
namespace {

// Scanners with several planes.

RangeScan Scan(SmallWorld& small, RaySensorDescription sensor) {
  WorldDescription world = small.world();
  AddSensor(world, RobotId(0), {0.0, 0.0, 0.5, 0.0}, RangerParameters{{std::move(sensor)}});
  return SensedScene(world).MeasureAs<RangerReading>(RobotId(0), 0).scan(0);
}

RaySensorDescription Planes(std::vector<double> elevations) {
  RaySensorDescription sensor = Fan(0.2, 3, 10.0);
  sensor.elevations = std::move(elevations);
  return sensor;
}

TEST(Planes, HitTopsUndersidesSidesAndTheGround) {
  SmallWorld world;
  world.AddRobot("r", {});
  world.AddBox("table", 3.0, 0.0, 4.0, 4.0, {0.3, 0.4}).ranger_return = 0.5;
  world.AddBox("lamp", 3.0, 0.0, 4.0, 4.0, {1.0, 1.1});
  const double up = std::atan(0.25);
  const double down = std::atan(0.05);
  const double steep = std::atan(0.8);
  const RangeScan scan = Scan(world, Planes({-steep, -down, 0.0, up}));
  ASSERT_EQ(scan.ranges.size(), 12u);
  ASSERT_EQ(scan.planes(), 4u);
  EXPECT_NEAR(scan.ranges[1], 0.5 / std::sin(steep), 1e-9);  // the ground
  EXPECT_EQ(scan.intensities[1], 1.0);
  EXPECT_NEAR(scan.ranges[4], 2.0 / std::cos(down), 1e-9);  // the table's top, 0.1 m lower
  EXPECT_EQ(scan.intensities[4], 0.5);
  EXPECT_EQ(scan.ranges[7], 10.0);  // between both
  EXPECT_EQ(scan.intensities[7], 0.0);
  EXPECT_NEAR(scan.ranges[10], 2.0 / std::cos(up), 1e-9);  // the lamp's underside, 0.5 m higher
  EXPECT_EQ(FlattestPlane(scan), 2u);
}

TEST(Planes, NoiseDiffersBetweenPlanesAndRepeats) {
  SmallWorld world;
  world.AddRobot("r", {});
  world.AddBox("wall", 3.0, 0.0, 2.0, 8.0, {0.0, 4.0});
  RaySensorDescription sensor = Planes({-0.001, 0.001});
  const RangeScan exact = Scan(world, sensor);
  sensor.noise_variance = 0.01;
  const RangeScan noisy = Scan(world, sensor);
  EXPECT_EQ(noisy, Scan(world, sensor));
  EXPECT_NE(noisy.ranges[0] - exact.ranges[0], noisy.ranges[3] - exact.ranges[3]);
  for (std::size_t i = 0; i < noisy.ranges.size(); ++i) EXPECT_NE(noisy.ranges[i], exact.ranges[i]);
}

}  // namespace
}  // namespace troupe::test
