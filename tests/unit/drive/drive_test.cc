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

}  // namespace
}  // namespace troupe
