// Pausing, playing and stepping a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "tests/unit/world-service/service/live_run_fixture.h"
#include "world-service/service/run_control.h"

namespace troupe::test {
namespace {

using testing::IsEmpty;

class ControlTest : public CoordinatorTest {
 protected:
  void Ask(const control::Request& request) {
    coordinator->Control(
        request, [this](const ControlReply& reply) { replies.push_back(reply); }, now);
  }
  // Answers a paused frame.
  void AnswerPaused(AgentId agent) {
    ProposalMessage message = ProposalOf(agent, 0.0);
    message.proposals.clear();
    message.paused = true;
    coordinator->OnProposal(message, now);
  }
  bool paused() const { return endpoint.frames.back().paused; }

  std::vector<ControlReply> replies;
};

TEST_F(ControlTest, PausesAfterTheOpenTickAndAnswersWhenQuiescent) {
  MakeAndStart(2);
  Ask(control::Pause());
  Propose(1);
  EXPECT_THAT(replies, IsEmpty());
  Propose(2);
  EXPECT_EQ(tick(), 1u);
  EXPECT_TRUE(paused());
  AnswerPaused(1);
  EXPECT_THAT(replies, IsEmpty());
  AnswerPaused(2);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done);
  EXPECT_EQ(replies[0].state, RunState::kPaused);
  EXPECT_EQ(replies[0].tick, 1u);
  EXPECT_EQ(replies[0].state_hash, endpoint.frames.back().state_hash);
  Wait(100.0);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(frames(), 2u) << "the frame of a quiescent pause is not resent";
}

TEST_F(ControlTest, IsPausedAtTheStartIfAsked) {
  options.start_paused = true;
  MakeAndStart(1);
  EXPECT_EQ(tick(), 0u);
  EXPECT_TRUE(paused());
  AnswerPaused(1);
  Ask(control::Play());
  EXPECT_TRUE(replies.back().done);
  EXPECT_FALSE(paused());
  Propose(1);
  Propose(1);
  EXPECT_EQ(tick(), 2u);
}

TEST_F(ControlTest, StepsTheGivenTicksAndAnswersWhenQuiescentAgain) {
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Step{.ticks = 3});
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(paused());
    EXPECT_THAT(replies, IsEmpty());
    Propose(1);
  }
  EXPECT_TRUE(paused());
  EXPECT_THAT(replies, IsEmpty());
  AnswerPaused(1);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].tick, 3u);
  EXPECT_EQ(replies[0].state, RunState::kPaused);
  EXPECT_GT(Travel(0), 0.0);
}

TEST_F(ControlTest, ExecutesStepsInTurnHoweverFastTheyAreRequested) {
  options.start_paused = true;
  MakeAndStart(1);
  Ask(control::Step{.ticks = 1});
  Ask(control::Step{.ticks = 2});
  AnswerPaused(1);
  Propose(1);
  AnswerPaused(1);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].tick, 1u);
  Propose(1);
  Propose(1);
  AnswerPaused(1);
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_EQ(replies[1].tick, 3u);
}

TEST_F(ControlTest, APauseCutsAStepShortAndItsReplySaysSo) {
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Step{.ticks = 5});
  Propose(1);
  Ask(control::Pause());
  Propose(1);
  AnswerPaused(1);
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_FALSE(replies[0].done);
  EXPECT_EQ(replies[0].problem, "paused after 2 of 5 ticks");
  EXPECT_TRUE(replies[1].done);
  EXPECT_EQ(replies[1].state, RunState::kPaused);
  EXPECT_EQ(tick(), 2u);
}

TEST_F(ControlTest, RefusesToStepWhilePlayingOrByZeroTicks) {
  MakeAndStart(1);
  Ask(control::Step{.ticks = 1});
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_FALSE(replies[0].done);
  EXPECT_EQ(replies[0].problem, "the run is playing; only a paused one can step");
  EXPECT_EQ(replies[0].state, RunState::kPlaying);
  Ask(control::Step{.ticks = 0});
  EXPECT_EQ(replies[1].problem, "ticks: found 0, expected at least 1");
}

TEST_F(ControlTest, ResendsAPausedFrameThatAnAgentMissed) {
  options.start_paused = true;
  MakeAndStart(2);
  AnswerPaused(1);
  Wait(0.2);
  EXPECT_GT(frames(), 1u);
  EXPECT_TRUE(paused());
  AnswerPaused(1);
  AnswerPaused(2);
  Ask(control::Pause());
  EXPECT_TRUE(replies.back().done);
}

TEST_F(ControlTest, ALateAnswerToAPausedFrameIsNoProposal) {
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Play());
  AnswerPaused(1);
  EXPECT_EQ(tick(), 0u);
  Propose(1);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(ControlTest, DoesNotWaitForAnAgentThatIsLostInAPause) {
  options.start_paused = true;
  MakeAndStart(2);
  Ask(control::Pause());
  AnswerPaused(1);
  EXPECT_THAT(replies, IsEmpty());
  coordinator->OnAgentGone(2, now);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done);
}

TEST_F(ControlTest, AnswersWaitingClientsWhenTheRunEnds) {
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Step{.ticks = 5});
  coordinator->Stop(now);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_FALSE(replies[0].done);
  EXPECT_EQ(replies[0].problem, "the run is over");
  EXPECT_EQ(replies[0].state, RunState::kOver);
}

TEST_F(ControlTest, StepsAtTheSpeedOfTheRun) {
  options.settings.speed = 2.0;
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Wait(10.0);
  Ask(control::Step{.ticks = 2});
  Propose(1);
  EXPECT_EQ(tick(), 0u) << "a tick of 0.1 s lasts 0.05 s at this speed";
  EXPECT_NEAR(coordinator->NextPoll() - now, 0.05, 1e-9);
  Wait(0.051);
  EXPECT_EQ(tick(), 1u);
  Propose(1);
  EXPECT_EQ(tick(), 1u);
  Wait(0.05);
  EXPECT_EQ(tick(), 2u);
  EXPECT_TRUE(paused());
}

TEST_F(ControlTest, APauseDoesNotWaitForTheTimeOfATickNeitherInAStep) {
  options.settings.speed = 0.001;
  options.start_paused = true;
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Step{.ticks = 5});
  Propose(1);
  Ask(control::Pause());
  Wait(0.0);
  EXPECT_EQ(tick(), 1u);
  EXPECT_TRUE(paused());
}

TEST_F(ControlTest, DoesNotCatchUpTheTimeOfAPause) {
  options.settings.speed = 1.0;
  MakeAndStart(1);
  Ask(control::Pause());
  Propose(1);
  AnswerPaused(1);
  Wait(10.0);
  Ask(control::Play());
  Propose(1);
  EXPECT_EQ(tick(), 1u) << "the next tick is due 0.1 s after the pause";
  Wait(0.1);
  EXPECT_EQ(tick(), 2u);
}

// Ticks wait for it, once all agents have shown them.
class ReleaseTest : public ControlTest, protected RunObserver {
 protected:
  ReleaseTest() { observers = {this}; }
  bool ShowsTick(Tick) override { return true; }
  Status OnTick(const CommittedTick&) override { return {}; }
  Status OnProgress(const RunProgress& progress) override {
    ticks_to_pause = progress.ticks_to_pause;
    return {};
  }
  Status OnShown(const FrameMessage& frame) override {
    shown.push_back(frame.state.tick);
    return {};
  }
  Result<TickRelease> Release() override {
    if (has_failed) return Failure("waited too long for a node");
    return is_released ? TickRelease{} : TickRelease{false, {"node"}};
  }
  bool holds() const { return endpoint.frames.back().holds; }

  bool is_released = false;
  bool has_failed = false;
  std::vector<Tick> shown;
  std::optional<std::uint64_t> ticks_to_pause;
};

TEST_F(ReleaseTest, ATickIsDecidedOnWhenItIsReleased) {
  MakeAndStart(2);
  EXPECT_TRUE(paused() && holds());
  AnswerPaused(1);
  EXPECT_THAT(shown, IsEmpty());
  AnswerPaused(2);
  EXPECT_THAT(shown, testing::ElementsAre(0));
  Wait(1.0);
  EXPECT_TRUE(paused() && holds());
  EXPECT_THAT(coordinator->MakeStatus(now).waiting_for, testing::ElementsAre("node"));
  Ask(control::GetStatus());
  EXPECT_EQ(replies.back().state, RunState::kPlaying);
  is_released = true;
  Wait(0.0);
  EXPECT_FALSE(paused() || holds());
  EXPECT_THAT(coordinator->MakeStatus(now + 1.0).waiting_for, testing::ElementsAre("r0", "r1"));
  Propose(1);
  Propose(2);
  EXPECT_EQ(tick(), 1u);
  EXPECT_TRUE(paused() && holds());
}

TEST_F(ReleaseTest, AWaitBecomesAPauseAndGoesOnWaiting) {
  MakeAndStart(1);
  AnswerPaused(1);
  Ask(control::Pause());
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].state, RunState::kPaused);
  EXPECT_TRUE(paused());
  EXPECT_FALSE(holds());
  EXPECT_EQ(ticks_to_pause, 0u);
  Ask(control::Play());
  EXPECT_EQ(replies[1].state, RunState::kPlaying);
  EXPECT_TRUE(paused() && holds());
  EXPECT_EQ(ticks_to_pause, std::nullopt);
  is_released = true;
  Wait(0.0);
  EXPECT_FALSE(paused());
}

TEST_F(ReleaseTest, AStepEndsWhenItsLastTickIsReleased) {
  options.start_paused = true;
  MakeAndStart(1);
  is_released = true;
  AnswerPaused(1);
  EXPECT_FALSE(holds());
  Ask(control::Step{.ticks = 1});
  is_released = false;
  Propose(1);
  AnswerPaused(1);
  EXPECT_THAT(replies, IsEmpty());
  is_released = true;
  Wait(0.0);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done);
  EXPECT_EQ(replies[0].tick, 1u);
}

TEST_F(ReleaseTest, AFailedWaitEndsTheRun) {
  MakeAndStart(1);
  AnswerPaused(1);
  has_failed = true;
  Wait(0.0);
  EXPECT_TRUE(endpoint.frames.back().last);
}

}  // namespace

}  // namespace troupe::test

namespace troupe {
namespace {

using ::testing::HasSubstr;

class RunControlTest : public test::LiveRunTest {
 protected:
  void MakeControl() {
    MakeAndBegin();
    editor_.emplace(*run_, *engine_);
    control_.emplace(*run_, *engine_, *editor_);
  }
  void Ask(const control::Request& request) {
    control_->Execute(
        request, [this](const ControlReply& reply) { replies_.push_back(reply); }, {}, now_);
  }
  void AnswerAndAdvance() {
    AnswerBoth();
    control_->Advance(now_);
  }

  std::optional<WorldEditor> editor_;
  std::optional<RunControl> control_;
  std::vector<ControlReply> replies_;
};

TEST_F(RunControlTest, RepliesToAPauseWhenItIsQuiescent) {
  MakeControl();
  Ask(control::Pause());
  control_->Advance(now_);
  EXPECT_TRUE(replies_.empty());
  AnswerAndAdvance();  // tick 1, paused
  EXPECT_TRUE(replies_.empty());
  AnswerAndAdvance();
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_TRUE(replies_[0].done);
  EXPECT_EQ(replies_[0].state, RunState::kPaused);
  control_->Advance(now_);
  EXPECT_EQ(replies_.size(), 1u);
}

TEST_F(RunControlTest, StepsAndEditsKeepTheirOrder) {
  options_.start_paused = true;
  MakeControl();
  Ask(control::Step{.ticks = 2});
  Ask(control::SetPose{"r0", {3.0, 0.0, 0.0, 0.0}});
  Ask(control::Step{.ticks = 1});
  AnswerAndAdvance();  // the pause at the start; the step begins
  AnswerAndAdvance();
  AnswerAndAdvance();
  EXPECT_TRUE(replies_.empty());
  AnswerAndAdvance();  // the pause after two ticks; the edit follows
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_EQ(replies_[0].tick, 2u);
  EXPECT_EQ(run_->frame.edition, 1u);
  AnswerAndAdvance();
  ASSERT_EQ(replies_.size(), 2u);
  EXPECT_EQ(replies_[1].edition, 1u);
  AnswerAndAdvance();
  AnswerAndAdvance();
  ASSERT_EQ(replies_.size(), 3u);
  EXPECT_EQ(replies_[2].tick, 3u);
  EXPECT_EQ(run_->frame.state.robots[0].X_WR.x, 3.1);
}

TEST_F(RunControlTest, AnEditOfAPlayingRunPausesOnlyForItself) {
  MakeControl();
  Ask(control::SetPose{"r0", {3.0, 0.0, 0.0, 0.0}});
  AnswerAndAdvance();
  EXPECT_TRUE(run_->frame.paused);
  AnswerAndAdvance();
  EXPECT_EQ(run_->frame.edition, 1u);
  AnswerAndAdvance();
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_EQ(replies_[0].state, RunState::kPlaying);
  EXPECT_FALSE(run_->frame.paused);
  EXPECT_FALSE(engine_->ticks_to_pause());
}

TEST_F(RunControlTest, RefusesAllThatIsOpenWhenTheRunIsOver) {
  options_.start_paused = true;
  MakeControl();
  Ask(control::Pause());
  Ask(control::Step());
  Ask(control::SetPose{"r0", {3.0, 0.0, 0.0, 0.0}});
  engine_->Stop(now_);
  control_->Advance(now_);
  ASSERT_EQ(replies_.size(), 3u);
  for (const ControlReply& reply : replies_) {
    EXPECT_FALSE(reply.done);
    EXPECT_EQ(reply.problem, "the run is over");
    EXPECT_EQ(reply.state, RunState::kOver);
  }
  Ask(control::Play());
  EXPECT_FALSE(replies_.back().done);
}

TEST_F(RunControlTest, RepliesToQueriesAtOnce) {
  MakeControl();
  Ask(control::Entities{.name = "r0"});
  Ask(control::GetStatus());
  Ask(control::Spawnables());
  ASSERT_EQ(replies_.size(), 3u);
  ASSERT_EQ(replies_[0].entities.size(), 1u);
  EXPECT_EQ(replies_[0].entities[0].name, "r0");
  EXPECT_TRUE(replies_[1].done);
  EXPECT_THAT(replies_[2].problem, HasSubstr("cannot read files"));
}

}  // namespace
}  // namespace troupe
