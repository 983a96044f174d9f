// The velocities that ROS nodes command.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/world_topics.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_gateway_fixture.h"

namespace troupe {
namespace {

using RobotCommandsTest = test::RosGatewayFixture;
using test::Eventually;
using test::Twist2;
using testing::ElementsAre;

TEST_F(RobotCommandsTest, ObeysACommandInTheNextProposal) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, -0.25)), (Twist{0.5, 0.0, -0.25}));
  const ProposalMessage answer = Tick();
  EXPECT_EQ(answer.proposals[0].twist, (Twist{0.5, 0.0, -0.25}));  // still valid
  EXPECT_TRUE(answer.proposals[1].twist.IsZero());
}

// Each writer writes as soon as it has discovered a reader, which may not have discovered the writer yet.
TEST_F(RobotCommandsTest, ObeysACommandThatIsSentOnce) {
  options_.robots.command_timeout = 0.0;
  MakeReplica(options_);
  for (int i = 1; i <= 20; ++i) {
    auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
    ASSERT_TRUE(Eventually([&] { return commands.wanted(); }));
    commands.Write(Twist2(0.01 * i, 0.0));
    ASSERT_TRUE(Eventually([&] { return Tick().proposals[0].twist.vx == 0.01 * i; }, 5.0)) << "command " << i;
  }
}

TEST_F(RobotCommandsTest, AppliesTheLatestOfManyCommands) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  CommandUntilMoving(commands, Twist2(0.5, 0.0));
  for (int i = 1; i <= 10'000; ++i) commands.Write(Twist2(1e-4 * i, 0.0));
  EXPECT_TRUE(Eventually([&] { return Tick().proposals[0].twist.vx == 1.0; }));
}

TEST_F(RobotCommandsTest, ReadsCommandsOfBestEffortWriters) {
  options_.robots.command_timeout = 0.0;
  MakeReplica(options_);
  ros::RosWriter<ros::TwistMessage> commands(peer_, "/a/cmd_vel", ros::Commands(false));
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, 0.0)).vx, 0.5);
}

// The reader beside a reliable one, which reads the messages of reliable writers.
TEST_F(RobotCommandsTest, AReaderForBestEffortWritersLeavesReliableOnesToTheOther) {
  ros::RosParticipant here(options_.network);
  ros::RosReader<ros::Float64> reader(ros::MakeNode(here, "/", "reader"), "/number", ros::Commands(false, 100),
                                      ros::Part::kBestEffortReader);
  auto reliable = Writer<ros::Float64>("/number");
  std::vector<double> numbers;
  const auto drain = [&] { reader.Drain([&](const ros::Float64& number) { numbers.push_back(number.data); }); };
  const auto has_last = [&] {
    drain();
    return !numbers.empty() && numbers.back() == 3.0;
  };
  // A message that is not reliable may arrive after the end of its writer, and is lost then.
  for (int attempt = 0; attempt < 10 && !has_last(); ++attempt) {
    {
      ros::RosWriter<ros::Float64> best_effort(peer_, "/number", ros::Commands(false));
      ASSERT_TRUE(Eventually([&] { return reliable.wanted() && best_effort.wanted(); }));
      ASSERT_TRUE(Eventually([&] {
        reliable.Write({1.0});
        best_effort.Write({2.0});
        drain();
        return !numbers.empty();
      }));
      numbers.clear();
      reliable.Write({1.0});
      best_effort.Write({3.0});
    }
    Eventually(has_last, 1.0);  // the writer has left
  }
  EXPECT_TRUE(has_last());
  EXPECT_THAT(numbers, testing::Not(testing::Contains(1.0)));
}

TEST_F(RobotCommandsTest, StopsARobotAfterTheCommandTimeout) {
  options_.robots.command_timeout = 1.0;  // 10 ticks
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  CommandUntilMoving(commands, Twist2(0.5, 0.0));
  int ticks = 0;
  ASSERT_TRUE(Eventually([&] {
    ++ticks;
    return Tick().proposals[0].twist.IsZero();
  }));
  EXPECT_GE(ticks, 10);  // more if the last repetition arrived late
}

TEST_F(RobotCommandsTest, ReadsCommandsOfBothTypesIfAsked) {
  options_.robots.command_type = ros::CommandType::kBoth;
  options_.robots.command_timeout = 0.0;
  MakeReplica(options_);
  auto stamped = Writer<ros::TwistStamped>("/a/cmd_vel");
  auto plain = Writer<ros::TwistMessage>("/a/cmd_vel");
  char frame[] = "";
  EXPECT_EQ(CommandUntilMoving(stamped, ros::TwistStamped{{{}, frame}, Twist2(0.5, 0.0)}).vx, 0.5);
  EXPECT_TRUE(Eventually([&] {
    plain.Write(Twist2(0.25, 0.0));
    return Tick().proposals[0].twist.vx == 0.25;
  }));
}

TEST_F(RobotCommandsTest, IgnoresCommandsThatAreNotFiniteAndSaysSo) {
  MakeReplica(options_);
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  std::vector<std::string> reports;
  ASSERT_TRUE(Eventually([&] {
    commands.Write(Twist2(std::numeric_limits<double>::quiet_NaN(), 0.0));
    const ProposalMessage answer = Tick();
    EXPECT_TRUE(answer.proposals[0].twist.IsZero());
    reports = answer.reports;
    return !reports.empty();
  }));
  EXPECT_THAT(reports, ElementsAre("robot a: cmd_vel: ignored a command that is not finite (1 so far)"));
  EXPECT_EQ(CommandUntilMoving(commands, Twist2(0.5, 0.0)).vx, 0.5);
}

TEST_F(RobotCommandsTest, LogsRefusedCommands) {
  MakeReplica(options_);
  ros::RosReader<rcl_interfaces_msg_dds__Log_> log(peer_, "/rosout", ros::LogLines());
  auto commands = Writer<ros::TwistMessage>("/a/cmd_vel");
  std::string text;
  ASSERT_TRUE(Eventually([&] {
    commands.Write(Twist2(std::nan(""), 0.0));
    Tick();
    log.Drain([&](const rcl_interfaces_msg_dds__Log_& line) {
      text = std::string(line.name) + ": " + line.msg;
      EXPECT_EQ(line.level, 30);
      EXPECT_GT(line.stamp.sec, 0);
    });
    return !text.empty();
  }));
  EXPECT_THAT(text, testing::StartsWith("a.robot: robot a: cmd_vel: ignored a command"));
}

}  // namespace
}  // namespace troupe
