#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/sensing/measure.h"

namespace troupe {
namespace {

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
    return Measure(world_.world(), state, robot_).scans[0].ranges;
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
  RaySensors(world_.robot(robot_).sensors[0]).push_back(sensor());
  const RangerReading reading = Measure(world_.world(), robot_);
  EXPECT_NE(reading.scans[0].ranges, reading.scans[1].ranges);
}

}  // namespace
}  // namespace troupe
