#include <gtest/gtest.h>

#include "common/model/device_limits.h"
#include "troupe/random.h"

namespace troupe {
namespace {

DriveDescription SomeDrive(DriveType type) {
  return {.type = type,
          .wheelbase = 0.5,
          .velocity = {{-0.5, 1.0}, {-0.2, 0.2}, {-1.0, 1.0}},
          .acceleration = {{-2.0, 1.0}, {-1.0, 1.0}, {-5.0, 5.0}}};
}

TEST(DriveLimits, KeepVelocitiesWithinTheirBounds) {
  DriveDescription drive = SomeDrive(DriveType::kOmni);
  const Interval any{-1e6, 1e6};
  drive.acceleration = {any, any, any};
  EXPECT_EQ(ClampToLimits(drive, {}, {5.0, 5.0, 5.0}, 0.1), (Twist{1.0, 0.2, 1.0}));
  EXPECT_EQ(ClampToLimits(drive, {}, {-5.0, -5.0, -5.0}, 0.1), (Twist{-0.5, -0.2, -1.0}));
  EXPECT_EQ(ClampToLimits(drive, {}, {0.3, -0.1, 0.2}, 0.1), (Twist{0.3, -0.1, 0.2}));
}

TEST(DriveLimits, KeepChangesWithinTheAccelerationBounds) {
  const DriveDescription drive = SomeDrive(DriveType::kOmni);
  EXPECT_EQ(ClampToLimits(drive, {}, {1.0, 0.2, 1.0}, 0.1), (Twist{0.1, 0.1, 0.5}));
  EXPECT_EQ(ClampToLimits(drive, {.vx = 0.8}, {}, 0.1), (Twist{.vx = 0.8 - 0.2}));
}

TEST(DriveLimits, BrakeAsHardAsPossibleWhenTooFast) {
  const DriveDescription drive = SomeDrive(DriveType::kDifferential);
  EXPECT_EQ(ClampToLimits(drive, {.vx = 3.0}, {.vx = 3.0}, 0.1), (Twist{.vx = 2.8}));
}

TEST(DriveLimits, DifferentialDriveDoesNotMoveSideways) {
  const DriveDescription drive = SomeDrive(DriveType::kDifferential);
  EXPECT_EQ(ClampToLimits(drive, {}, {0.05, 0.05, 0.1}, 0.1), (Twist{0.05, 0.0, 0.1}));
  EXPECT_FALSE(WithinLimits(drive, {}, {0.05, 0.05, 0.1}, 0.1));
}

TEST(DriveLimits, CarTwistFollowsTheSteeredWheel) {
  EXPECT_EQ(CarTwist(1.0, 0.0, 0.5), (Twist{1.0, 0.0, 0.0}));
  const Twist left = CarTwist(2.0, kPi / 6.0, 0.5);
  EXPECT_NEAR(left.vx, 2.0 * 0.8660254037844386, 1e-12);
  EXPECT_NEAR(left.wz, 2.0 * 0.5 / 0.5, 1e-12);
  EXPECT_EQ(left.vy, 0.0);
}

TEST(DriveLimits, CarBoundsSpeedAndSteering) {
  DriveDescription drive = SomeDrive(DriveType::kCar);
  drive.velocity.heading = {-0.6, 0.6};
  const auto expect_near = [](const Twist& a, const Twist& b) {
    EXPECT_NEAR(a.vx, b.vx, 1e-12);
    EXPECT_EQ(a.vy, 0.0);
    EXPECT_NEAR(a.wz, b.wz, 1e-12);
  };
  const Twist cruising = CarTwist(1.0, 0.0, 0.5);
  expect_near(ClampToLimits(drive, cruising, CarTwist(1.0, 0.4, 0.5), 0.1), CarTwist(1.0, 0.4, 0.5));
  expect_near(ClampToLimits(drive, cruising, CarTwist(1.0, 1.4, 0.5), 0.1), CarTwist(1.0, 0.6, 0.5));
  expect_near(ClampToLimits(drive, cruising, CarTwist(9.0, -0.4, 0.5), 0.1), CarTwist(1.0, -0.4, 0.5));
  expect_near(ClampToLimits(drive, {}, CarTwist(1.0, 0.3, 0.5), 0.1), CarTwist(0.1, 0.3, 0.5));
  expect_near(ClampToLimits(drive, {}, CarTwist(-1.0, 0.3, 0.5), 0.1), CarTwist(-0.2, 0.3, 0.5));
  expect_near(ClampToLimits(drive, {}, {}, 0.1), {});
}

TEST(DriveLimits, AcceptTwistsThatTheyClamped) {
  for (DriveType type : {DriveType::kDifferential, DriveType::kOmni, DriveType::kCar}) {
    const DriveDescription drive = SomeDrive(type);
    Twist current;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const auto draw = [&](std::uint64_t k) { return 6.0 * RandomUniform({i, k}) - 3.0; };
      const Twist desired{draw(0), draw(1), draw(2)};
      const Twist next = ClampToLimits(drive, current, desired, 0.1);
      ASSERT_TRUE(WithinLimits(drive, current, next, 0.1)) << "draw " << i;
      ASSERT_FALSE(WithinLimits(drive, current, {next.vx + 3.0, next.vy, next.wz}, 0.1)) << "draw " << i;
      current = next;
    }
  }
}

}  // namespace
}  // namespace troupe
