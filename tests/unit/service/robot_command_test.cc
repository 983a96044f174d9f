// Commands to robots from outside, and the speed of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/service/coordinator_fixture.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class RobotCommandTest : public CoordinatorTest {
 protected:
  ControlReply Command(const std::string& robot, RobotCommand command, std::uint64_t ticks) {
    ControlRequest request{
        .command = ControlCommand::kCommandRobot, .ticks = ticks, .name = robot, .robot_command = std::move(command)};
    return Ask(request);
  }
  static RobotCommand Drive(double vx) {
    RobotCommand command;
    command.twist = Twist{vx, 0.0, 0.0};
    return command;
  }
  static RobotCommand GoTo(std::vector<Vec2> waypoints) {
    RobotCommand command;
    command.goal = Goal{0, std::move(waypoints)};
    return command;
  }
  const std::vector<RobotCommand>& sent() const { return endpoint.frames.back().commands; }
};

TEST_F(RobotCommandTest, IsInTheNextFramesForItsTicks) {
  MakeAndStart(2);
  ASSERT_TRUE(Command("r1", Drive(0.5), 2).done);
  EXPECT_THAT(sent(), IsEmpty()) << "the frame of the open tick was sent before";
  const auto step = [this] {
    Propose(1);
    Propose(2);
  };
  for (int i = 0; i < 2; ++i) {
    step();
    ASSERT_EQ(sent().size(), 1u) << i;
    EXPECT_EQ(sent()[0].robot, RobotId(1));
    EXPECT_EQ(sent()[0].twist, (Twist{0.5, 0.0, 0.0}));
  }
  step();
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(RobotCommandTest, IsReplacedByTheNextOfItsKind) {
  Make(1);
  JoinMessage join = JoinOf(1, {"r0"});
  join.accept_goals = {"r0"};
  coordinator->OnJoin(join, now);
  Command("r0", Drive(0.5), 100);
  Command("r0", GoTo({{1.0, 2.0}}), 100);
  Propose(1);
  ASSERT_EQ(sent().size(), 1u);
  ASSERT_TRUE(sent()[0].goal);
  EXPECT_EQ(sent()[0].goal->waypoints.size(), 1u);
  const std::uint32_t first = sent()[0].goal->number;
  Command("r0", Drive(0.0), 1);
  Command("r0", GoTo({{1.0, 2.0}}), 100);
  Propose(1);
  EXPECT_EQ(sent()[0].twist, Twist());
  EXPECT_NE(sent()[0].goal->number, first) << "the same points again are another goal";
  Command("r0", GoTo({}), 1);
  Propose(1);
  EXPECT_THAT(sent(), IsEmpty()) << "the twist has expired, and the goal was cancelled";
}

TEST_F(RobotCommandTest, CountsInAPauseFromTheNextTickOn) {
  options.start_paused = true;
  MakeAndStart(1);
  Command("r0", Drive(0.5), 1);
  ProposalMessage answer = ProposalOf(1, 0.0);
  answer.proposals.clear();
  answer.paused = true;
  coordinator->OnProposal(answer, now);
  EXPECT_THAT(sent(), IsEmpty());
  ControlRequest play;
  play.command = ControlCommand::kPlay;
  ASSERT_TRUE(Ask(play).done);
  ASSERT_EQ(sent().size(), 1u);
  Propose(1);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(RobotCommandTest, IsRefusedWithTheReason) {
  MakeAndStart(1);
  EXPECT_THAT(Command("missing", Drive(1.0), 1).problem, HasSubstr("no robot 'missing'"));
  EXPECT_THAT(Command("r0", Drive(1.0), 0).problem, HasSubstr("0 ticks"));
  RobotCommand grip;
  grip.grippers = {{.gripper = 0, .opening = 0.0}};
  EXPECT_THAT(Command("r0", grip, 1).problem, HasSubstr("gripper 0, but it has 0"));
  Propose(1);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(RobotCommandTest, RefusesAGoalThatTheControllerWouldIgnore) {
  Make(2);
  JoinMessage join = JoinOf(1, {"r0", "r1"});
  join.accept_goals = {"r1"};
  coordinator->OnJoin(join, now);
  // Both have the same controller: the newest statement counts.
  EXPECT_TRUE(Command("r0", GoTo({{1.0, 1.0}}), 5).done);
  EXPECT_THAT(Command("r0", GoTo({{1e9, 1.0}}), 5).problem, HasSubstr("beyond"));

  MakeAndStart(1);
  EXPECT_THAT(Command("r0", GoTo({{1.0, 1.0}}), 5).problem, HasSubstr("accepts no goals"));
  EXPECT_TRUE(Command("r0", GoTo({}), 5).done) << "there is nothing to cancel";
}

TEST_F(RobotCommandTest, OfARunThatIsResetEnds) {
  MakeAndStart(1);
  Command("r0", Drive(0.5), 100);
  Propose(1);
  ASSERT_EQ(sent().size(), 1u);
  ControlRequest reset;
  reset.command = ControlCommand::kReset;
  Ask(reset);
  Propose(1);
  for (int i = 0; i < 2; ++i) {
    ProposalMessage answer = ProposalOf(1, 0.0);
    answer.proposals.clear();
    answer.paused = true;
    coordinator->OnProposal(answer, now);
  }
  ASSERT_EQ(endpoint.frames.back().edition, 1u);
  ASSERT_FALSE(endpoint.frames.back().paused);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(RobotCommandTest, TheSpeedOfARunChangesFromTheNextTickOn) {
  options.settings.speed = 1.0;
  MakeAndStart(1);
  ControlRequest request{.command = ControlCommand::kSpeed, .speed = 10.0};
  ASSERT_TRUE(Ask(request).done);
  EXPECT_EQ(coordinator->MakeStatus(now).speed, 10.0);
  Propose(1);
  Wait(0.005);
  EXPECT_EQ(tick(), 0u);
  Wait(0.006);
  EXPECT_EQ(tick(), 1u);
  request.speed.reset();
  ASSERT_TRUE(Ask(request).done);
  Propose(1);
  EXPECT_EQ(tick(), 2u) << "without a pace the last proposal makes the step";
  request.speed = -1.0;
  EXPECT_THAT(Ask(request).problem, HasSubstr("not a positive number"));
  EXPECT_EQ(coordinator->MakeStatus(now).speed, std::nullopt);
}

TEST_F(RobotCommandTest, RealtimeModeNeedsASpeed) {
  options.settings.mode = Mode::kRealtime;
  MakeAndStart(1);
  ControlRequest request;
  request.command = ControlCommand::kSpeed;
  EXPECT_THAT(Ask(request).problem, HasSubstr("needs a speed"));
}

}  // namespace
}  // namespace troupe::test
