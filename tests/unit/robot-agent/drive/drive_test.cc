#include "robot-agent/drive/drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/model/device_limits.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kTickLength = 0.1;  // s

DriveDescription MakeDrive(DriveType type) {
  return {.type = type,
          .wheelbase = 0.5,
          .velocity = {{-0.5, 1.0}, {-0.3, 0.3}, {-1.0, 1.0}},
          .acceleration = {{-4.0, 2.0}, {-1.0, 1.0}, {-5.0, 5.0}}};
}

Twist FinalTwist(const DriveDescription& drive, const Command& command) {
  Twist twist;
  for (int i = 0; i < 100; ++i) twist = DriveTowards(drive, twist, command, kTickLength);
  return twist;
}

TEST(DriveTest, DifferentialDriveReachesItsCommand) {
  const DriveDescription drive = MakeDrive(DriveType::kDifferential);
  EXPECT_EQ(FinalTwist(drive, {.twist = {0.7, 0.0, -0.4}}), (Twist{0.7, 0.0, -0.4}));
}

TEST(DriveTest, DifferentialDriveDoesNotMoveSideways) {
  const DriveDescription drive = MakeDrive(DriveType::kDifferential);
  EXPECT_EQ(FinalTwist(drive, {.twist = {0.0, 0.2, 0.0}}), Twist{});
}

TEST(DriveTest, OmniDriveMovesSideways) {
  const DriveDescription drive = MakeDrive(DriveType::kOmni);
  EXPECT_EQ(FinalTwist(drive, {.twist = {0.1, 0.2, 0.3}}), (Twist{0.1, 0.2, 0.3}));
}

TEST(DriveTest, VelocityIsBounded) {
  const DriveDescription drive = MakeDrive(DriveType::kOmni);
  EXPECT_EQ(FinalTwist(drive, {.twist = {9.0, 9.0, 9.0}}), (Twist{1.0, 0.3, 1.0}));
  EXPECT_EQ(FinalTwist(drive, {.twist = {-9.0, -9.0, -9.0}}), (Twist{-0.5, -0.3, -1.0}));
}

TEST(DriveTest, AccelerationAndBrakingAreBounded) {
  const DriveDescription drive = MakeDrive(DriveType::kDifferential);
  EXPECT_NEAR(DriveTowards(drive, {}, {.twist = {1.0, 0.0, 0.0}}, kTickLength).vx, 0.2, 1e-12);
  EXPECT_NEAR(DriveTowards(drive, {1.0, 0.0, 0.0}, {}, kTickLength).vx, 0.6, 1e-12);
}

TEST(DriveTest, CarTurnsBySteering) {
  const DriveDescription drive = MakeDrive(DriveType::kCar);
  const Twist twist = FinalTwist(drive, {.twist = {}, .speed = 0.8, .steering = 0.3});
  EXPECT_NEAR(twist.vx, 0.8 * std::cos(0.3), 1e-12);
  EXPECT_NEAR(twist.wz, 0.8 * std::sin(0.3) / 0.5, 1e-12);
  EXPECT_EQ(twist.vy, 0.0);
}

TEST(DriveTest, CarReversesAndStops) {
  const DriveDescription drive = MakeDrive(DriveType::kCar);
  const Twist back = FinalTwist(drive, {.twist = {}, .speed = -0.4, .steering = 0.3});
  EXPECT_LT(back.vx, 0.0);
  EXPECT_LT(back.wz, 0.0);
  EXPECT_TRUE(FinalTwist(drive, {.twist = {}, .speed = 0.0, .steering = 0.3}).IsZero());
}

TEST(DriveTest, CarSteeringBeyondItsBoundKeepsTheSpeed) {
  const DriveDescription drive = MakeDrive(DriveType::kCar);
  const Twist twist = FinalTwist(drive, {.twist = {}, .speed = 0.8, .steering = 3.0});
  EXPECT_NEAR(twist.vx, 0.8 * std::cos(1.0), 1e-12);
}

TEST(DriveTest, ANumberThatIsNotFiniteCountsAsZero) {
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  const DriveDescription omni = MakeDrive(DriveType::kOmni);
  EXPECT_EQ(FinalTwist(omni, {.twist = {nan, 0.2, infinity}}), (Twist{0.0, 0.2, 0.0}));
  const DriveDescription car = MakeDrive(DriveType::kCar);
  EXPECT_TRUE(FinalTwist(car, {.twist = {}, .speed = nan, .steering = 0.1}).IsZero());
  EXPECT_EQ(FinalTwist(car, {.twist = {}, .speed = 0.5, .steering = -infinity}), (Twist{0.5, 0.0, 0.0}));
}

TEST(DriveTest, ProposesOnlyTwistsThatTheServiceAccepts) {
  for (DriveType type : {DriveType::kDifferential, DriveType::kOmni, DriveType::kCar}) {
    const DriveDescription drive = MakeDrive(type);
    Twist twist;
    for (int i = 0; i < 1000; ++i) {
      const double a = 3.0 * SinCos(0.7 * i).sin;
      const double b = 3.0 * SinCos(1.3 * i).cos;
      const Command command{.twist = {a, b, a - b}, .speed = a, .steering = b};
      const Twist next = DriveTowards(drive, twist, command, kTickLength);
      ASSERT_TRUE(WithinLimits(drive, twist, next, kTickLength)) << i;
      twist = next;
    }
  }
}

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

TEST(CommandFromTwist, PassesATwistToADriveThatFollowsOne) {
  EXPECT_EQ(CommandFromTwist({1.0, 2.0, 3.0}, {}).twist, (Twist{1.0, 2.0, 3.0}));
}

TEST(CommandFromTwist, SteersACarOntoTheArcOfTheTwist) {
  DriveDescription car{.type = DriveType::kCar, .wheelbase = 0.5};
  for (const double vx : {1.0, -0.5}) {
    for (const double wz : {0.0, 0.75, -0.25}) {
      const Command command = CommandFromTwist({vx, 9.0, wz}, car);
      const Twist twist = CarTwist(command.speed, command.steering, car.wheelbase);
      EXPECT_NEAR(twist.vx, vx, 1e-12);
      EXPECT_NEAR(twist.wz, wz, 1e-12);
    }
  }
  EXPECT_EQ(CommandFromTwist({0.0, 0.0, 1.0}, car).speed, 0.0);
}

}  // namespace
}  // namespace troupe
