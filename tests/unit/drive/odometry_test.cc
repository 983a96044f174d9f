#include <gtest/gtest.h>

#include "robot-agent/drive/drive.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

void ExpectNear(const Pose& actual, const Pose& expected, double tolerance = 1e-9) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
  EXPECT_NEAR(WrapAngle(actual.heading - expected.heading), 0.0, tolerance);
}

LocalizationDescription MakeOdometry(const Pose& origin) {
  return {.type = LocalizationType::kOdometry, .origin = origin};
}

TEST(OdometryTest, GpsIsTheTruePose) {
  LocalizationDescription gps{.origin = {5.0, 5.0, 0.0, 1.0}, .error_x = 0.5};
  Odometry odometry(gps);
  const Pose X_WR{1.0, 2.0, 0.5, -3.0};
  odometry.Update({});
  odometry.Update(X_WR);
  EXPECT_EQ(odometry.estimate(), X_WR);
}

TEST(OdometryTest, StartsAtItsOriginWhereverTheRobotIs) {
  const LocalizationDescription localization = MakeOdometry({1.0, 2.0, 0.0, 0.5});
  Odometry odometry(localization);
  odometry.Update({-7.0, 3.0, 0.1, 2.0});
  EXPECT_EQ(odometry.estimate(), localization.origin);
}

TEST(OdometryTest, MotionIsReadInTheRobotsFrame) {
  const LocalizationDescription localization = MakeOdometry({});
  Odometry odometry(localization);
  odometry.Update({4.0, 4.0, 0.0, kPi / 2});
  odometry.Update({4.0, 5.0, 0.0, kPi / 2});  // a metre ahead
  ExpectNear(odometry.estimate(), {1.0, 0.0, 0.0, 0.0});
  odometry.Update({3.0, 5.0, 0.0, kPi / 2});  // a metre to the left
  ExpectNear(odometry.estimate(), {1.0, 1.0, 0.0, 0.0});
}

TEST(OdometryTest, WithoutErrorsItFollowsTheTruth) {
  const Pose X_WR0{2.0, -1.0, 0.0, 0.7};
  const Pose X_OR0{-3.0, 4.0, 0.0, -2.0};
  const LocalizationDescription localization = MakeOdometry(X_OR0);
  Odometry odometry(localization);
  Pose X_WR = X_WR0;
  odometry.Update(X_WR);
  for (int i = 0; i < 1000; ++i) {
    X_WR = X_WR * Integrate({0.5, SinCos(0.1 * i).sin, 0.8 * SinCos(0.03 * i).cos}, 0.1);
    odometry.Update(X_WR);
    ExpectNear(odometry.estimate(), X_OR0 * Inverse(X_WR0) * X_WR);
  }
}

TEST(OdometryTest, ErrorsAreRelativeToEachMotion) {
  LocalizationDescription localization = MakeOdometry({});
  localization.error_x = 0.1;
  localization.error_y = -0.2;
  localization.error_heading = 0.5;
  Odometry odometry(localization);
  odometry.Update({});
  for (int i = 1; i <= 10; ++i) odometry.Update({0.5 * i, 0.25 * i, 0.0, 0.0});
  ExpectNear(odometry.estimate(), {5.0 * 1.1, 2.5 * 0.8, 0.0, 0.0});
  odometry.Update({5.0, 2.5, 0.0, 0.4});
  ExpectNear(odometry.estimate(), {5.0 * 1.1, 2.5 * 0.8, 0.0, 0.6});
}

TEST(OdometryTest, TurningRoundAndRoundDoesNotJump) {
  LocalizationDescription localization = MakeOdometry({});
  localization.error_heading = 0.25;
  Odometry odometry(localization);
  Pose X_WR;
  odometry.Update(X_WR);
  for (int i = 0; i < 100; ++i) {
    X_WR = X_WR * Pose{0.0, 0.0, 0.0, 0.1};
    odometry.Update(X_WR);
  }
  ExpectNear(odometry.estimate(), {0.0, 0.0, 0.0, WrapAngle(10.0 * 1.25)});
}

TEST(OdometryTest, ARobotAtRestCountsNoMotion) {
  LocalizationDescription localization = MakeOdometry({1.0, 1.0, 0.0, 0.3});
  localization.error_x = 0.5;
  Odometry odometry(localization);
  for (int i = 0; i < 100; ++i) odometry.Update({0.1, 0.2, 0.0, 0.3});
  EXPECT_EQ(odometry.estimate(), localization.origin);
}

TEST(OdometryTest, ARelocationIsNoMotion) {
  const LocalizationDescription localization = MakeOdometry({});
  Odometry odometry(localization);
  odometry.Update({0.0, 0.0, 0.0, 0.0});
  odometry.Update({1.0, 0.0, 0.0, 0.0});
  odometry.Relocate({5.0, 5.0, 0.0, kPi / 2});
  odometry.Update({5.0, 5.0, 0.0, kPi / 2});
  ExpectNear(odometry.estimate(), {1.0, 0.0, 0.0, 0.0});
  odometry.Update({5.0, 6.0, 0.0, kPi / 2});
  ExpectNear(odometry.estimate(), {2.0, 0.0, 0.0, 0.0});
}

}  // namespace
}  // namespace troupe
