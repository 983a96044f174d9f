#include "world-service/service/run_control.h"

#include <gmock/gmock.h>

#include <optional>
#include <vector>

#include "tests/unit/service/live_run_fixture.h"

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
  void Ask(ControlCommand command, std::uint64_t ticks = 1) {
    ControlRequest request{.command = command, .ticks = ticks, .name = "r0", .pose = {3.0, 0.0, 0.0, 0.0}};
    control_->Execute(
        request, [this](const ControlReply& reply) { replies_.push_back(reply); }, nullptr, now_);
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
  Ask(ControlCommand::kPause);
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
  Ask(ControlCommand::kStep, 2);
  Ask(ControlCommand::kSetPose);
  Ask(ControlCommand::kStep, 1);
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
  Ask(ControlCommand::kSetPose);
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
  Ask(ControlCommand::kPause);
  Ask(ControlCommand::kStep);
  Ask(ControlCommand::kSetPose);
  engine_->Stop(now_);
  control_->Advance(now_);
  ASSERT_EQ(replies_.size(), 3u);
  for (const ControlReply& reply : replies_) {
    EXPECT_FALSE(reply.done);
    EXPECT_EQ(reply.problem, "the run is over");
    EXPECT_EQ(reply.state, RunState::kOver);
  }
  Ask(ControlCommand::kPlay);
  EXPECT_FALSE(replies_.back().done);
}

TEST_F(RunControlTest, RepliesToQueriesAtOnce) {
  MakeControl();
  Ask(ControlCommand::kEntities);
  Ask(ControlCommand::kStatus);
  Ask(ControlCommand::kSpawnables);
  ASSERT_EQ(replies_.size(), 3u);
  ASSERT_EQ(replies_[0].entities.size(), 1u);
  EXPECT_EQ(replies_[0].entities[0].name, "r0");
  EXPECT_TRUE(replies_[1].done);
  EXPECT_THAT(replies_[2].problem, HasSubstr("cannot read files"));
}

}  // namespace
}  // namespace troupe
