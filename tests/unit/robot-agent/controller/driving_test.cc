#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "tests/support/values.h"
#include "tests/unit/robot-agent/controller/controlled_robot.h"

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

using ::testing::IsEmpty;

// Distance along `bearing` to a wall `ahead` metres before the robot that spans the bearings [from, to].
auto WallAhead(double ahead, double from, double to) {
  return [=](double bearing) { return bearing >= from && bearing <= to ? ahead / std::cos(bearing) : 100.0; };
}

class WanderTest : public ::testing::Test {
 protected:
  void Make(std::vector<SensorDescription> sensors, DriveType drive = DriveType::kDifferential,
            const std::string& parameters = R"({"speed": 0.5, "turn_rate": 0.7, "min_distance": 1})") {
    robot_ = MakeRobot("wander", parameters, std::move(sensors), drive);
    controller_ = test::ValueOf(CreateFor(robot_));
  }

  template <typename RangeAtBearing>
  Command See(RangeAtBearing range, bool stalled = false) {
    std::vector<SensorReading> readings;
    for (const SensorDescription& ranger : robot_.sensors) readings.push_back(Read(ranger, range));
    return controller_->Update(At(tick_++, readings, stalled));
  }

  RobotDescription robot_;
  std::unique_ptr<Controller> controller_;
  Tick tick_ = 0;
};

const auto kNothing = [](double) { return 100.0; };

TEST_F(WanderTest, DrivesAheadWhereNothingIs) {
  Make({MakeScanner()});
  EXPECT_EQ(See(kNothing).twist, (Twist{0.5, 0.0, 0.0}));
}

TEST_F(WanderTest, IgnoresObstaclesBesideIt) {
  Make({MakeScanner()});
  EXPECT_EQ(See([](double bearing) { return std::abs(bearing) > 1.2 ? 0.3 : 100.0; }).twist.vx, 0.5);
}

TEST_F(WanderTest, TurnsToTheSideWithMoreRoom) {
  Make({MakeScanner()});
  EXPECT_EQ(See(WallAhead(0.8, -0.2, 1.5)).twist, (Twist{0.0, 0.0, -0.7}));
  Make({MakeScanner()});
  EXPECT_EQ(See(WallAhead(0.8, -1.5, 0.2)).twist, (Twist{0.0, 0.0, 0.7}));
}

TEST_F(WanderTest, KeepsItsTurnUntilTheWayIsClear) {
  Make({MakeScanner()});
  EXPECT_EQ(See(WallAhead(0.8, -1.5, 0.2)).twist.wz, 0.7);
  EXPECT_EQ(See(WallAhead(0.8, -0.2, 1.5)).twist.wz, 0.7);  // the other side has more room now
  EXPECT_EQ(See(kNothing).twist.vx, 0.5);
  EXPECT_EQ(See(WallAhead(0.8, -0.2, 1.5)).twist.wz, -0.7);
}

TEST_F(WanderTest, UsesTheRangerWithMostSamples) {
  Make({MakeSonar(), MakeScanner()});
  EXPECT_THAT(controller_->Subscriptions(), ElementsAre(1u));
  Make({MakeSonar()});
  EXPECT_THAT(controller_->Subscriptions(), ElementsAre(0u));
  EXPECT_EQ(See(WallAhead(0.8, -0.5, 0.5)).twist.vx, 0.0);
}

TEST_F(WanderTest, LooksAheadThroughAScannerMountedBackwards) {
  robot_ = MakeRobot("wander", "{}", {MakeScanner()});
  controller_ = test::ValueOf(
      CreateController({.robot = &robot_, .parameters = "{}", .sensors = {{&robot_.sensors[0], Pose{0, 0, 0, kPi}}}}));
  EXPECT_GT(See(WallAhead(0.8, -0.5, 0.5)).twist.vx, 0.0);  // that wall is behind the robot
}

TEST_F(WanderTest, AShortSightedScannerThatSeesNothingIsClear) {
  SensorDescription scanner = MakeScanner();
  RaySensors(scanner)[0].range.max = 0.5;
  Make({scanner});
  EXPECT_EQ(See(kNothing).twist.vx, 0.5);
  EXPECT_EQ(See(WallAhead(0.4, -1.0, 1.0)).twist.vx, 0.0);
}

TEST_F(WanderTest, BacksOffAndTurnsAfterAStall) {
  Make({MakeScanner()});
  EXPECT_LT(See(kNothing, true).twist.vx, 0.0);
  for (int i = 1; i < 10; ++i) EXPECT_LT(See(kNothing).twist.vx, 0.0) << i;
  EXPECT_NE(See(kNothing).twist.wz, 0.0);
  int turning = 1;
  while (See(kNothing).twist.wz != 0.0 && turning < 100) ++turning;
  EXPECT_GE(turning, 11);  // at least pi/4 at 0.7 rad/s
  EXPECT_LE(turning, 35);
  EXPECT_EQ(See(kNothing).twist.vx, 0.5);
}

TEST_F(WanderTest, TurnsToTheSameSideAndFartherAfterAnotherStall) {
  Make({MakeScanner()});
  const auto left_is_free = WallAhead(0.8, -1.5, 0.2);
  const auto right_is_free = WallAhead(0.8, -0.2, 1.5);
  const auto update = [&](auto range, bool stalled) {
    const std::vector<SensorReading> readings = {Read(robot_.sensors[0], range)};
    Observation observation = At(tick_++, readings, stalled);
    observation.pose_estimate.x = 0.05 * static_cast<double>(tick_);  // it moves on
    return controller_->Update(observation).twist;
  };
  // The turn after a stall (rad, to the left): what it sees at the stall decides.
  const auto turn_after_stall = [&](auto range) {
    EXPECT_LT(update(range, true).vx, 0.0);
    for (int i = 1; i < 10; ++i) EXPECT_LT(update(range, false).vx, 0.0) << i;
    double turn = 0.0;
    for (Twist twist = update(kNothing, false); twist.vx == 0.0; twist = update(kNothing, false))
      turn += 0.1 * twist.wz;
    return turn;
  };
  EXPECT_GT(turn_after_stall(left_is_free), 0.2 * kPi);
  EXPECT_GT(turn_after_stall(right_is_free), 0.45 * kPi);
  for (int i = 0; i < 300; ++i) update(kNothing, false);
  EXPECT_LT(turn_after_stall(right_is_free), -0.2 * kPi);
}

TEST_F(WanderTest, MakesRoomInItsCircleBeforeItTurns) {
  const std::string parameters = R"({"speed": 0.5, "turn_rate": 0.7, "min_distance": 1, "clearance": 0.5})";
  Make({MakeScanner()}, DriveType::kDifferential, parameters);
  EXPECT_EQ(See(WallAhead(0.8, -0.2, 0.4)).twist, (Twist{0.0, 0.0, -0.7})) << "nothing is in the circle";
  EXPECT_LT(See(WallAhead(0.4, -0.2, 0.4)).twist.vx, 0.0);
  EXPECT_EQ(See(WallAhead(0.8, -0.2, 0.4)).twist.wz, -0.7);
}

TEST_F(WanderTest, LeavesWhatStopsItInATurnBehindAndTurnsTheOtherWay) {
  const std::string parameters = R"({"speed": 0.5, "turn_rate": 0.7, "min_distance": 1, "clearance": 0.4})";
  Make({MakeScanner()}, DriveType::kDifferential, parameters);
  const auto left_is_free = WallAhead(0.8, -1.4, 0.2);
  EXPECT_EQ(See(left_is_free).twist.wz, 0.7);
  EXPECT_GT(See(left_is_free, true).twist.vx, 0.0);
  Twist twist = See(left_is_free).twist;
  for (int i = 0; i < 20 && twist.vx > 0.0; ++i) twist = See(left_is_free).twist;
  EXPECT_EQ(twist.wz, -0.7);
}

TEST_F(WanderTest, TriesOtherMotionsWhereItsWayBackAndItsTurnAreBlocked) {
  for (const DriveType drive : {DriveType::kDifferential, DriveType::kOmni, DriveType::kCar}) {
    Make({MakeScanner()}, drive);
    tick_ = 0;
    std::set<std::string> tried;
    for (int i = 0; i < 300; ++i) {
      const Command command = See(kNothing, true);
      if (command.speed > 0.0 || command.twist.vx > 0.0) tried.insert("ahead");
      if (command.speed < 0.0 || command.twist.vx < 0.0) tried.insert("back");
      if (command.steering > 0.0 || command.twist.wz > 0.0) tried.insert("left");
      if (command.steering < 0.0 || command.twist.wz < 0.0) tried.insert("right");
      if (command.twist.vy != 0.0) tried.insert("aside");
      if (i == 20) {
        EXPECT_FALSE(tried.contains("ahead")) << "its own manoeuvre comes first";
      }
    }
    EXPECT_EQ(tried.size(), drive == DriveType::kOmni ? 5u : 4u);
  }
}

// As with its back at a wall: its turns to both sides move it, and end at contacts.
TEST_F(WanderTest, DrivesAheadWhereItCanOnlyTurnToAndFro) {
  Make({MakeScanner()});
  const std::vector<SensorReading> readings = {Read(robot_.sensors[0], WallAhead(0.8, -0.5, 0.5))};
  double heading = 0.0;
  bool stalled = true;
  bool ahead = false;
  for (Tick tick = 1; tick < 400 && !ahead; ++tick) {
    Observation observation = At(tick, readings, stalled);
    observation.pose_estimate.heading = heading;
    const Command command = controller_->Update(observation);
    ahead = command.twist.vx > 0.0;
    const double turned = std::clamp(heading + 0.1 * command.twist.wz, -0.3, 0.3);
    stalled = command.twist.vx < 0.0 || (command.twist.wz != 0.0 && turned == heading);
    heading = turned;
  }
  EXPECT_TRUE(ahead);
}

TEST_F(WanderTest, DrivesIntoANarrowPlaceAfterAWholeCircle) {
  Make({MakeScanner()});
  const auto narrow = [](double) { return 0.7; };
  int turning = 0;
  while (See(narrow).twist.vx == 0.0 && turning < 200) ++turning;
  EXPECT_NEAR(turning, 2.0 * kPi / 0.7 / 0.1, 2.0);
  EXPECT_EQ(See(narrow).twist.vx, 0.5);
  EXPECT_EQ(See(kNothing).twist.vx, 0.5);
  EXPECT_EQ(See(narrow).twist.vx, 0.0) << "no longer a narrow place";
}

TEST_F(WanderTest, WithoutRangersUsesStalls) {
  Make({});
  EXPECT_THAT(controller_->Subscriptions(), IsEmpty());
  EXPECT_EQ(See(kNothing).twist.vx, 0.5);
  EXPECT_LT(See(kNothing, true).twist.vx, 0.0);
}

TEST_F(WanderTest, BeforeTheFirstReadingDrivesAsIfNothingWereThere) {
  Make({MakeScanner()});
  const std::vector<SensorReading> unread(1);
  EXPECT_EQ(controller_->Update(At(1, unread)).twist.vx, 0.5);
}

TEST_F(WanderTest, ACarTurnsWhileReversing) {
  Make({MakeScanner()}, DriveType::kCar);
  EXPECT_EQ(See(kNothing).speed, 0.5);
  const Command command = See(WallAhead(0.8, -1.5, 0.2));
  EXPECT_LT(command.speed, 0.0);
  EXPECT_LT(command.steering, 0.0);  // backwards, this turns the nose to the left
}

}  // namespace
}  // namespace troupe
