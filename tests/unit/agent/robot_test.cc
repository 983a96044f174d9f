#include "robot-agent/robot/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

// One robot in front of a wall, alone in its agent.
class RobotTest : public ::testing::Test {
 protected:
  RobotTest() {
    id_ = world_.AddRobot("r0", {});
    world_.AddBox("wall", 3.0, 0.0, 1.0, 9.0, {0.0, 1.0});
  }
  ~RobotTest() override { std::filesystem::remove(log_path_); }

  void Make(bool with_log = false) {
    if (with_log) {
      log_ = test::ValueOf(ScanLog::Open(log_path_));
    }
    scene_ = std::make_unique<Scene>(world_.world());
    index_ = std::make_unique<BodyIndex>(*scene_);
    robot_ = test::ValueOf(Robot::Create(*scene_, id_, {log_.get(), AllowedPaths::All()}));
    state_ = PlacedState(world_.world());
  }
  Twist Decide(Tick tick) {
    state_.tick = tick;
    index_->Assign(state_);
    return robot_->Decide(state_, *index_).twist;
  }
  std::vector<std::string> LogLines() {
    EXPECT_TRUE(log_->Flush().ok());
    return test::LinesOf(test::TextOf(log_path_));
  }

  std::string log_path_ = ::testing::TempDir() + "/troupe_robot_test_" + std::to_string(getpid());
  SmallWorld world_;
  RobotId id_;
  std::unique_ptr<ScanLog> log_;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<BodyIndex> index_;
  std::unique_ptr<Robot> robot_;
  WorldState state_;
};

TEST_F(RobotTest, StaysWithinItsDrivesLimits) {
  world_.robot(id_).drive.acceleration.x = {-2.0, 1.0};
  world_.SetController(id_, "script", R"({"commands": [{"at": 0, "vx": 9}]})");
  Make();
  EXPECT_NEAR(Decide(0).vx, 0.1, 1e-12);
  state_.robots[0].twist.vx = 0.95;
  EXPECT_EQ(Decide(1).vx, 1.0);
}

TEST_F(RobotTest, TimeIsCountedInTicks) {
  world_.world().interval_ns = 20'000'000;
  world_.SetController(id_, "script", R"({"commands": [{"at": 0.5, "vx": 0.4}]})");
  Make();
  EXPECT_EQ(Decide(24).vx, 0.0);
  EXPECT_EQ(Decide(25).vx, 0.4);
}

TEST_F(RobotTest, TheControllerSeesItsRanger) {
  world_.AddRanger(id_, {0.0, 0.0, 0.3, 0.0}, {Fan(1.0, 11)});
  world_.SetController(id_, "wander", R"({"min_distance": 1})");
  Make();
  EXPECT_GT(Decide(0).vx, 0.0);
  state_.robots[0].X_WR.x = 2.0;  // half a metre before the wall
  EXPECT_EQ(Decide(1).vx, 0.0);
}

TEST_F(RobotTest, AScannerMountedBackwardsLooksBack) {
  world_.AddRanger(id_, {0.0, 0.0, 0.3, kPi}, {Fan(1.0, 11)});
  world_.SetController(id_, "wander");
  Make();
  state_.robots[0].X_WR.x = 2.0;
  EXPECT_GT(Decide(0).vx, 0.0);
}

TEST_F(RobotTest, ASlowRangerKeepsItsReadingUntilItIsDue) {
  world_.AddRanger(id_, {0.0, 0.0, 0.3, 0.0}, {Fan(1.0, 11)});
  world_.robot(id_).sensors[0].period_ticks = 5;
  world_.SetController(id_, "wander");
  Make();
  EXPECT_GT(Decide(0).vx, 0.0);
  state_.robots[0].X_WR.x = 2.0;
  for (Tick tick = 1; tick < 5; ++tick) EXPECT_GT(Decide(tick).vx, 0.0) << tick;
  EXPECT_EQ(Decide(5).vx, 0.0);
}

TEST_F(RobotTest, TheScanLogHasEveryRangerWhenDue) {
  world_.AddRanger(id_, {0.0, 0.0, 0.3, 0.0}, {OneRay(), OneRay(1.0)});
  world_.AddRanger(id_, {0.0, 0.0, 0.3, 0.0}, {OneRay()});
  world_.robot(id_).sensors[1].period_ticks = 2;
  Make(true);
  Decide(0);
  Decide(1);
  EXPECT_THAT(LogLines(), ::testing::ElementsAre(R"({"tick":0,"robot":"r0","sensor":"ranger:0.0","ranges":[2.5]})",
                                                 R"({"tick":0,"robot":"r0","sensor":"ranger:0.1","ranges":[1]})",
                                                 R"({"tick":0,"robot":"r0","sensor":"ranger:1.0","ranges":[2.5]})",
                                                 R"({"tick":1,"robot":"r0","sensor":"ranger:0.0","ranges":[2.5]})",
                                                 R"({"tick":1,"robot":"r0","sensor":"ranger:0.1","ranges":[1]})"));
}

TEST_F(RobotTest, DecidesTheSameWithAndWithoutAScanLog) {
  world_.AddRanger(id_, {0.0, 0.0, 0.3, 0.0}, {Fan(1.0, 11), OneRay()});
  world_.AddRanger(id_, {0.0, 0.0, 0.3, 0.0}, {Fan(1.0, 5)});
  RaySensors(world_.robot(id_).sensors[0])[0].noise_variance = 0.1;
  world_.SetController(id_, "expand");
  std::vector<Twist> decisions[2];
  for (bool with_log : {false, true}) {
    Make(with_log);
    for (Tick tick = 0; tick < 50; ++tick) {
      state_.robots[0].X_WR = state_.robots[0].X_WR * Integrate(state_.robots[0].twist, 0.1);
      state_.robots[0].twist = Decide(tick);
      decisions[with_log].push_back(state_.robots[0].twist);
    }
  }
  EXPECT_EQ(decisions[0], decisions[1]);
}

class ExternalCommandTest : public RobotTest {
 protected:
  Twist Decide(Tick tick, const RobotCommand& command) {
    ExternalCommand external;
    AddCommand(command, world_.robot(id_).drive, external);
    state_.tick = tick;
    index_->Assign(state_);
    return robot_->Decide(state_, *index_, external).twist;
  }
};

TEST_F(ExternalCommandTest, ItsTwistReplacesTheControllersMotion) {
  world_.SetController(id_, "script", R"({"commands": [{"at": 0, "vx": 0.5}]})");
  Make();
  RobotCommand command;
  EXPECT_EQ(Decide(0, command).vx, 0.5);
  command.twist = Twist{-0.25, 0.0, 1.0};
  EXPECT_EQ(Decide(1, command), *command.twist);
  command.twist = Twist{-9.0, 0.0, 0.0};
  EXPECT_EQ(Decide(2, command).vx, -1.0) << "the drive bounds it";
}

TEST_F(ExternalCommandTest, ItsGoalIsInTheFrameOfThePoseEstimate) {
  const std::string library = std::string(TEST_LIBRARY_FOLDER) + "/libcontroller_goals.so";
  world_.SetController(id_, library);
  // Its odometry begins at (0, 0), where it is at (1, 2), turned by a quarter.
  world_.robot(id_).localization.type = LocalizationType::kOdometry;
  Make();
  ASSERT_TRUE(robot_->accepts_goals());
  state_.robots[0].X_WR = {1.0, 2.0, 0.0, 0.5 * kPi};
  RobotCommand command;
  EXPECT_EQ(Decide(0, command), Twist());
  command.goal = Goal{1, {{0.5, 2.75}}};
  const Twist shown = Decide(1, command);
  EXPECT_NEAR(shown.vx, 0.75, 1e-12);
  EXPECT_NEAR(shown.wz, 0.5, 1e-12);
  command.goal.reset();
  EXPECT_EQ(Decide(2, command), Twist());
}

TEST_F(ExternalCommandTest, OtherControllersHaveNoGoals) {
  Make();
  EXPECT_FALSE(robot_->accepts_goals());
}

TEST_F(RobotTest, AnErrorNamesTheRobot) {
  world_.SetController(id_, "fly");
  const Scene scene(world_.world());
  const auto robot = Robot::Create(scene, id_);
  ASSERT_FALSE(robot.ok());
  EXPECT_THAT(robot.error().message, ::testing::StartsWith("robot r0: unknown controller 'fly'"));
}

}  // namespace
}  // namespace troupe
