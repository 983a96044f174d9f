#include "robot-agent/robot/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "robot-agent/program/command_line.h"
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

class ScanLogTest : public ::testing::Test {
 protected:
  std::string Text() const { return test::TextOf(path_); }

  const test::TemporaryFolder folder_;
  const std::string path_ = folder_.Path("scans");
};

TEST_F(ScanLogTest, AppendsToTheCompleteLinesOfAKeptFile) {
  for (int tick = 0; tick < 2; ++tick) {  // the first time there is no file
    auto log = test::ValueOf(ScanLog::Open(path_, true));
    log->Write("{\"tick\":" + std::to_string(tick) + "}\n");
    EXPECT_TRUE(log->Flush().ok());
    std::ofstream(path_, std::ios::app) << "{\"tick\":9,\"rob";
  }
  test::ValueOf(ScanLog::Open(path_, true));
  EXPECT_EQ(Text(),
            "{\"tick\":0}\n"
            "{\"tick\":1}\n");
  EXPECT_TRUE(ScanLog::Open(path_).ok());
  EXPECT_EQ(Text(), "");
}

TEST_F(ScanLogTest, MarksARestart) {
  auto log = test::ValueOf(ScanLog::Open(path_));
  log->Write("{\"tick\":5}\n");
  log->Restart(3);
  log->Write("{\"tick\":0}\n");
  EXPECT_TRUE(log->Flush().ok());
  EXPECT_EQ(Text(), "{\"tick\":5}\n{\"edition\":3}\n{\"tick\":0}\n");
}

TEST_F(ScanLogTest, KeepsItsFirstError) {
  auto log = test::ValueOf(ScanLog::Open("/dev/full"));
  log->Write("{\"tick\":0}\n");
  const Status first = log->Flush();
  ASSERT_FALSE(first.ok());
  EXPECT_EQ(first.error().ToString(), "/dev/full: error: cannot write scans: No space left on device");
  log->Write("{\"tick\":1}\n");
  EXPECT_FALSE(log->status().ok());
}

using ::testing::ElementsAre;

std::variant<AgentCommandLine, int> Parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "robot-agent");
  return ParseAgentCommandLine(static_cast<int>(arguments.size()), arguments.data());
}

AgentCommandLine ParseGood(std::vector<const char*> arguments) {
  const auto parsed = Parse(std::move(arguments));
  EXPECT_TRUE(std::holds_alternative<AgentCommandLine>(parsed));
  return std::holds_alternative<AgentCommandLine>(parsed) ? std::get<AgentCommandLine>(parsed) : AgentCommandLine{};
}

TEST(AgentCommandLineTest, ReadsEveryOption) {
  const AgentCommandLine line = ParseGood(
      {"--session", "lab",           "--robot",       "r0",       "--robot",           "r1",  "--domain", "7",
       "--service", "10.0.0.1:7410", "--interface",   "10.0.0.5", "--lease",           "3.5", "--scans",  "scans.jsonl",
       "--faults",  "loss=0.25",     "--start-delay", "0.5",      "--session-timeout", "9"});
  EXPECT_EQ(line.network.session, "lab");
  EXPECT_THAT(line.agent.robots, ElementsAre("r0", "r1"));
  EXPECT_EQ(line.network.domain, 7u);
  EXPECT_EQ(line.network.service_address, "10.0.0.1:7410");
  EXPECT_EQ(line.network.network_interface, "10.0.0.5");
  EXPECT_EQ(line.network.lease_seconds, 3.5);
  EXPECT_EQ(line.agent.scan_log, "scans.jsonl");
  EXPECT_EQ(line.faults.loss, 0.25);
  EXPECT_EQ(line.start_delay_seconds, 0.5);
  EXPECT_EQ(line.agent.session_timeout_seconds, 9.0);
}

TEST(AgentCommandLineTest, TheInterfaceFollowsFromWhereTheServiceIs) {
  EXPECT_EQ(ParseGood({"--session=s", "--robot=r"}).network.network_interface, "lo");
  EXPECT_EQ(ParseGood({"--session=s", "--robot=r", "--service=there"}).network.network_interface, "auto");
}

TEST(AgentCommandLineTest, BadUsageIsExitStatusTwo) {
  const std::vector<std::vector<const char*>> table = {
      {},
      {"--robot=r"},
      {"--session=s"},
      {"--session=", "--robot=r"},
      {"--session=*", "--robot=r"},
      {"--session=s", "--robot="},
      {"--session=s", "--robot"},
      {"--session=s", "--robot=r", "another"},
      {"--session=s", "--robot=r", "--domain=231"},
      {"--session=s", "--robot=r", "--domain=-1"},
      {"--session=s", "--robot=r", "--lease=0"},
      {"--session=s", "--robot=r", "--lease=nan"},
      {"--session=s", "--robot=r", "--start-delay=-1"},
      {"--session=s", "--robot=r", "--session-timeout=soon"},
      {"--session=s", "--robot=r", "--faults=luck"},
      {"--session=s", "--robot=r", "--wings"},
  };
  for (const std::vector<const char*>& arguments : table) {
    const auto parsed = Parse(arguments);
    ASSERT_TRUE(std::holds_alternative<int>(parsed));
    EXPECT_EQ(std::get<int>(parsed), kExitBadInput);
  }
}

TEST(AgentCommandLineTest, HelpAndVersionAreNoFailure) {
  EXPECT_EQ(std::get<int>(Parse({"--help"})), kExitDone);
  EXPECT_EQ(std::get<int>(Parse({"--version"})), kExitDone);
}

}  // namespace
}  // namespace troupe
