#include <gtest/gtest.h>

#include "common/model/device_limits.h"
#include "robot-agent/drive/drive.h"

namespace troupe {
namespace {

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
