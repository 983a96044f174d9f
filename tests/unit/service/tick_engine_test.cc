#include "world-service/service/tick_engine.h"

#include <gmock/gmock.h>

#include "tests/unit/service/live_run_fixture.h"

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
  engine_->LoseSilentMembers(now_);
  EXPECT_EQ(run_->members.present_members(), 2u);
  now_ += 0.2;
  engine_->LoseSilentMembers(now_);
  EXPECT_EQ(run_->members.present_members(), 1u);
  EXPECT_EQ(run_->frame.state.tick, 2u);  // the other proposal is enough now
}

TEST_F(TickEngineTest, IsHaltedByALossOnlyIfTheSettingsSayPause) {
  MakeAndBegin();
  engine_->OnAgentGone(1, now_);
  EXPECT_FALSE(engine_->halted());

  options_.settings.on_agent_loss = OnAgentLoss::kPause;
  MakeAndBegin();
  engine_->OnAgentGone(1, now_);
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
  engine_->OnAgentGone(1, now_);
  engine_->OnAgentGone(2, now_);
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
  const ControlRequest request;
  engine_->PublishEdit(next, {request}, now_);
  EXPECT_EQ(endpoint_.frames.back().state, state);
  EXPECT_TRUE(endpoint_.frames.back().paused);
  AnswerBoth();
  EXPECT_TRUE(engine_->pause_answered());
}

}  // namespace
}  // namespace troupe
