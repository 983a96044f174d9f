#include "world-service/service/tick_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "tests/unit/world-service/service/live_run_fixture.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class TickEngineTest : public test::LiveRunTest {};

TEST_F(TickEngineTest, StepsWithTheLastProposal) {
  MakeAndBegin();
  ASSERT_EQ(endpoint_.frames.size(), 1u);
  Answer(2);
  EXPECT_THAT(engine_->MissingMembers(), ElementsAre(1));
  EXPECT_EQ(run_->frame.state.tick, 0u);
  Answer(1);
  EXPECT_EQ(run_->frame.state.tick, 1u);
  EXPECT_EQ(engine_->steps(), 1u);
  ASSERT_EQ(endpoint_.frames.size(), 2u);
  EXPECT_EQ(endpoint_.frames.back().state, run_->frame.state);
}

TEST_F(TickEngineTest, BeginsWithObjectsAtRest) {
  WorldDescription world = test::PlaneWorld(2);
  world.models.push_back(world.models.back());
  world.models.back().name = "box";
  world.models.back().X_PM = {50.0, 0.0, 0.0, 0.0};
  world.objects = {ModelId(world.models.size() - 1)};
  Make();
  run_->scene = std::make_shared<const Scene>(world);
  const TickEngine engine(*run_, now_);
  EXPECT_EQ(run_->frame.state.objects[0].mode, ObjectMode::kResting);
}

TEST_F(TickEngineTest, PausesAfterAsManyTicksAsSet) {
  MakeAndBegin();
  engine_->SetTicksToPause(2);
  AnswerBoth();
  EXPECT_FALSE(run_->frame.paused);
  AnswerBoth();
  EXPECT_TRUE(run_->frame.paused);
  EXPECT_EQ(engine_->ticks_to_pause(), 0u);
  EXPECT_FALSE(engine_->pause_answered());
  AnswerBoth();
  EXPECT_TRUE(engine_->pause_answered());
  EXPECT_EQ(run_->frame.state.tick, 2u);

  engine_->SetTicksToPause(std::nullopt);
  engine_->Resume(now_);
  EXPECT_FALSE(endpoint_.frames.back().paused);
  AnswerBoth();
  EXPECT_EQ(run_->frame.state.tick, 3u);
}

TEST_F(TickEngineTest, ResendsTheFrameToTheAgentThatIsMissing) {
  MakeAndBegin();
  Answer(1);
  now_ = engine_->NextPoll();
  engine_->Poll(now_);
  ASSERT_EQ(endpoint_.frames.size(), 2u);
  EXPECT_THAT(endpoint_.frames.back().awaited, ElementsAre(2));
  EXPECT_EQ(engine_->frames_resent(), 1u);
  EXPECT_THAT(run_->frame.awaited, IsEmpty());
}

TEST_F(TickEngineTest, LosesAMemberThatIsSilentForTheDeadline) {
  options_.settings.agent_deadline_seconds = 3.0;
  MakeAndBegin();
  Answer(1);
  Answer(2);
  Answer(1);
  now_ += 2.9;
  engine_->WatchSilentMembers(now_);
  EXPECT_EQ(run_->members.present_members(), 2u);
  now_ += 0.2;
  engine_->WatchSilentMembers(now_);
  EXPECT_EQ(run_->members.present_members(), 1u);
  EXPECT_EQ(run_->frame.state.tick, 2u);  // the other proposal is enough now
}

TEST_F(TickEngineTest, IsHaltedByALossOnlyIfTheSettingsSayPause) {
  MakeAndBegin();
  engine_->OnAgentGone(1, "it ended", now_);
  EXPECT_FALSE(engine_->halted());

  options_.settings.on_agent_loss = OnAgentLoss::kPause;
  MakeAndBegin();
  engine_->OnAgentGone(1, "it ended", now_);
  EXPECT_TRUE(engine_->halted());
  Answer(2);
  EXPECT_EQ(run_->frame.state.tick, 0u);
}

TEST_F(TickEngineTest, AFailureIsTheRunsErrorAndEndsWithTheLastFrame) {
  MakeAndBegin();
  engine_->Fail(Failure("out of luck"), now_);
  EXPECT_EQ(run_->phase, RunPhase::kEnding);
  EXPECT_EQ(run_->error.error().message, "out of luck");
  EXPECT_TRUE(endpoint_.frames.back().last);
  engine_->Fail(Failure("again"), now_);
  EXPECT_EQ(run_->error.error().message, "out of luck");
  engine_->OnAgentGone(1, "it ended", now_);
  engine_->OnAgentGone(2, "it ended", now_);
  EXPECT_EQ(run_->phase, RunPhase::kOver);
}

TEST_F(TickEngineTest, AnEditIsPublishedPausedAndIsAnsweredLikeATick) {
  MakeAndBegin();
  engine_->SetTicksToPause(0);
  WorldState state = run_->frame.state;
  state.robots[0].X_WR.x = 5.0;
  FrameMessage next = SuccessorOf(run_->frame);
  ++next.edition;
  next.state = state;
  const control::Request request = control::Reset();
  engine_->PublishEdit(next, {request}, now_);
  EXPECT_EQ(endpoint_.frames.back().state, state);
  EXPECT_TRUE(endpoint_.frames.back().paused);
  AnswerBoth();
  EXPECT_TRUE(engine_->pause_answered());
}

}  // namespace

}  // namespace troupe

namespace troupe::test {
namespace {

// Commands to robots from outside, and the speed of a run.

using testing::HasSubstr;
using testing::IsEmpty;

class RobotCommandTest : public CoordinatorTest {
 protected:
  ControlReply Command(const std::string& robot, const RobotCommand& command, std::uint64_t ticks) {
    return Ask(control::CommandRobot{robot, ticks, command.twist, command.grippers, command.goal});
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
  control::Play play;
  ASSERT_TRUE(Ask(play).done);
  ASSERT_EQ(sent().size(), 1u);
  Propose(1);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(RobotCommandTest, IsRefusedWithTheReason) {
  MakeAndStart(1);
  EXPECT_THAT(Command("missing", Drive(1.0), 1).problem, HasSubstr("no robot 'missing'"));
  EXPECT_THAT(Command("r0", Drive(1.0), 0).problem, HasSubstr("ticks: found 0, expected from 1"));
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
  control::Reset reset;
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
  control::Speed request{.speed = 10.0};
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
  EXPECT_THAT(Ask(request).problem, HasSubstr("speed: found"));
  EXPECT_EQ(coordinator->MakeStatus(now).speed, std::nullopt);
}

TEST_F(RobotCommandTest, RealtimeModeNeedsASpeed) {
  options.settings.mode = Mode::kRealtime;
  MakeAndStart(1);
  control::Speed request;
  EXPECT_THAT(Ask(request).problem, HasSubstr("needs a speed"));
}

}  // namespace
}  // namespace troupe::test
