#include "robot-agent/ros/twist_command.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/model/drive_limits.h"

namespace troupe {
namespace {

ros::TwistMessage Message(double vx, double vy, double wz) {
  ros::TwistMessage message{};
  message.linear.x = vx;
  message.linear.y = vy;
  message.angular.z = wz;
  return message;
}

TEST(CommandFromTwist, PassesATwistToADriveThatFollowsOne) {
  const std::optional<Command> command = CommandFromTwist(Message(1.0, 2.0, 3.0), {});
  ASSERT_TRUE(command);
  EXPECT_EQ(command->twist, (Twist{1.0, 2.0, 3.0}));
}

TEST(CommandFromTwist, RefusesNumbersThatAreNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(CommandFromTwist(Message(bad, 0.0, 0.0), {}));
    EXPECT_FALSE(CommandFromTwist(Message(0.0, bad, 0.0), {}));
    EXPECT_FALSE(CommandFromTwist(Message(0.0, 0.0, bad), {}));
  }
}

TEST(CommandFromTwist, SteersACarOntoTheArcOfTheTwist) {
  DriveDescription car;
  car.type = DriveType::kCar;
  car.wheelbase = 0.5;
  for (const double vx : {1.0, -0.5}) {
    for (const double wz : {0.0, 0.75, -0.25}) {
      const std::optional<Command> command = CommandFromTwist(Message(vx, 9.0, wz), car);
      ASSERT_TRUE(command);
      const Twist twist = CarTwist(command->speed, command->steering, car.wheelbase);
      EXPECT_NEAR(twist.vx, vx, 1e-12);
      EXPECT_NEAR(twist.wz, wz, 1e-12);
    }
  }
  EXPECT_EQ(CommandFromTwist(Message(0.0, 0.0, 1.0), car)->speed, 0.0);
}

}  // namespace
}  // namespace troupe
