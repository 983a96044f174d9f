#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/values.h"
#include "tests/unit/controller/controlled_robot.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;

class ExpandTest : public ::testing::Test {
 protected:
  void Make(std::vector<SensorDescription> sensors, DriveType drive = DriveType::kDifferential) {
    robot_ = MakeRobot("expand", R"({"speed": 0.5, "turn_gain": 2})", std::move(sensors), drive);
    controller_ = test::ValueOf(CreateFor(robot_));
  }

  template <typename RangeAtBearing>
  Command See(RangeAtBearing range, bool stalled = false) {
    std::vector<SensorReading> readings;
    for (const SensorDescription& ranger : robot_.sensors) readings.push_back(Read(ranger, range));
    return controller_->Update(At(0, readings, stalled));
  }

  RobotDescription robot_;
  std::unique_ptr<Controller> controller_;
};

// The only room is around `bearing`.
auto RoomAt(double at, double elsewhere) {
  return [=](double bearing) { return std::abs(WrapAngle(bearing - at)) < 0.1 ? 5.0 : elsewhere; };
}

TEST_F(ExpandTest, TurnsToTheVectorSumOfTheRanges) {
  Make({MakeSonar()});
  EXPECT_NEAR(See(RoomAt(kPi / 2, 1.0)).twist.wz, 2.0 * kPi / 2, 1e-9);
  EXPECT_NEAR(See(RoomAt(-kPi / 4, 1.0)).twist.wz, -2.0 * kPi / 4, 1e-9);
  // Ahead 2 m, to the left 3 m, in other directions 1 m: the sum is (1, 2).
  const Command command = See(
      [](double bearing) { return std::abs(bearing) < 0.1 ? 2.0 : (std::abs(bearing - kPi / 2) < 0.1 ? 3.0 : 1.0); });
  EXPECT_NEAR(command.twist.wz, 2.0 * std::atan2(2.0, 1.0), 1e-9);
}

TEST_F(ExpandTest, DrivesOnlyWhenTheFrontIsClear) {
  Make({MakeSonar()});
  EXPECT_EQ(See(RoomAt(0.0, 1.0)).twist.vx, 0.5);
  EXPECT_EQ(See(RoomAt(kPi / 2, 1.0)).twist.vx, 0.5);
  EXPECT_EQ(See(RoomAt(kPi / 2, 0.5)).twist.vx, 0.0);
  EXPECT_EQ(See(RoomAt(0.0, 0.5)).twist.vx, 0.5);  // the near wall is beside it
}

TEST_F(ExpandTest, PrefersSonarToScanner) {
  Make({MakeScanner(), MakeSonar()});
  EXPECT_THAT(controller_->Subscriptions(), ElementsAre(1u));
  Make({MakeScanner()});
  EXPECT_THAT(controller_->Subscriptions(), ElementsAre(0u));
  EXPECT_GT(See([](double bearing) { return bearing > 0 ? 8.0 : 1.0; }).twist.wz, 0.5);
}

TEST_F(ExpandTest, AfterAStallTriesEveryWayOutForAMoment) {
  Make({MakeSonar()});
  int back = 0;
  int ahead = 0;
  int left = 0;
  int right = 0;
  for (Tick stall = 0; stall < 1000; stall += 10) {
    const std::vector<SensorReading> readings = {Read(robot_.sensors[0], RoomAt(0.0, 1.0))};
    const Twist way = controller_->Update(At(stall, readings, true)).twist;
    back += way.vx < 0.0;
    ahead += way.vx > 0.0;
    left += way.wz > 0.0;
    right += way.wz < 0.0;
    EXPECT_EQ(controller_->Update(At(stall + 4, readings)).twist, way);
    EXPECT_EQ(controller_->Update(At(stall + 5, readings)).twist.vx, 0.5);
  }
  EXPECT_GT(back, 30);
  EXPECT_GT(ahead, 10);
  EXPECT_GT(left, 5);
  EXPECT_GT(right, 5);
}

TEST_F(ExpandTest, StandsStillBeforeTheFirstReading) {
  Make({MakeSonar()});
  const std::vector<SensorReading> unread(1);
  EXPECT_TRUE(controller_->Update(At(1, unread)).twist.IsZero());
}

TEST_F(ExpandTest, ACarSteersToTheRoom) {
  Make({MakeSonar()}, DriveType::kCar);
  const Command ahead = See(RoomAt(kPi / 4, 1.0));
  EXPECT_EQ(ahead.speed, 0.5);
  EXPECT_GT(ahead.steering, 0.0);
  const Command blocked = See(RoomAt(kPi / 2, 0.5));
  EXPECT_LT(blocked.speed, 0.0);
  EXPECT_LT(blocked.steering, 0.0);
}

TEST(ExpandWithoutRangerTest, IsAnError) {
  const RobotDescription robot = MakeRobot("expand", "{}");
  const auto controller = CreateFor(robot);
  ASSERT_FALSE(controller.ok());
  EXPECT_EQ(controller.error().message,
            "expand: the robot has no ranger with several rays, expected a sonar ring or a scanner");
}

}  // namespace
}  // namespace troupe
