#include "world-service/service/world_editor.h"

#include <gmock/gmock.h>

#include <optional>

#include "tests/unit/service/live_run_fixture.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class WorldEditorTest : public test::LiveRunTest {
 protected:
  void MakeEditor() {
    MakeAndBegin();
    editor_.emplace(*run_, *engine_);
  }
  static ControlRequest Request(ControlCommand command, const std::string& name, const Pose& pose = {}) {
    ControlRequest request;
    request.command = command;
    request.name = name;
    request.pose = pose;
    return request;
  }
  std::optional<WorldEditor> editor_;
};

TEST_F(WorldEditorTest, AnEditBeginsAnEditionAndPauses) {
  MakeEditor();
  ASSERT_TRUE(editor_->Apply(Request(ControlCommand::kSetPose, "r0", {3.0, 0.0, 0.0, 0.0}), nullptr, now_).ok());
  const FrameMessage& frame = endpoint_.frames.back();
  EXPECT_EQ(frame.edition, 1u);
  EXPECT_EQ(frame.world_edition, 0u);  // the description is the same
  EXPECT_TRUE(frame.paused);
  EXPECT_EQ(frame.state.robots[0].X_WR.x, 3.0);
  EXPECT_THAT(run_->notices.Drain(), ElementsAre("tick 0: the pose of 'r0' is set"));
}

TEST_F(WorldEditorTest, AnErrorChangesNothing) {
  MakeEditor();
  const Result<ControlRequest> applied = editor_->Apply(Request(ControlCommand::kDelete, "r7"), nullptr, now_);
  ASSERT_FALSE(applied.ok());
  EXPECT_THAT(applied.error().message, HasSubstr("no entity 'r7'"));
  EXPECT_EQ(endpoint_.frames.size(), 1u);
  EXPECT_EQ(run_->frame.edition, 0u);
  EXPECT_THAT(run_->notices.Drain(), IsEmpty());
}

TEST_F(WorldEditorTest, KeepsDeletedEntitiesForARestoration) {
  MakeEditor();
  EXPECT_EQ(editor_->Deleted("r0"), nullptr);
  ASSERT_TRUE(editor_->Apply(Request(ControlCommand::kDelete, "r0"), nullptr, now_).ok());
  const auto deleted = editor_->Deleted("r0");
  ASSERT_NE(deleted, nullptr);
  ControlRequest spawn = Request(ControlCommand::kSpawn, "again", {0.0, 5.0, 0.0, 0.0});
  ASSERT_TRUE(editor_->Apply(spawn, deleted.get(), now_).ok());
  EXPECT_EQ(run_->world().robots.back().name, "again");
  EXPECT_EQ(run_->world().robots.back().drive, run_->world().robots.front().drive);
}

TEST_F(WorldEditorTest, ASpawnedRobotNeedsAnAgentInTime) {
  options_.start_timeout_seconds = 5.0;
  MakeEditor();
  const WorldDescription one = test::PlaneWorld(1);
  ControlRequest spawn = Request(ControlCommand::kSpawn, "r0", {0.0, 5.0, 0.0, 0.0});
  spawn.rename = true;
  const Result<ControlRequest> applied = editor_->Apply(spawn, &one, now_);
  ASSERT_TRUE(applied.ok()) << applied.error().message;
  EXPECT_EQ(applied.value().name, "r00");
  EXPECT_EQ(run_->world().robots.size(), 3u);
  EXPECT_EQ(endpoint_.sessions.back().world_edition, 1u);
  EXPECT_THAT(editor_->DrainNewRobots(), ElementsAre("r00"));
  EXPECT_THAT(editor_->DrainNewRobots(), IsEmpty());
  EXPECT_THAT(editor_->robots_without_agent(), ElementsAre(RobotId(2)));

  EXPECT_TRUE(editor_->CheckTimeout(now_ + 4.9).ok());
  const Status late = editor_->CheckTimeout(now_ + 5.0);
  ASSERT_FALSE(late.ok());
  EXPECT_THAT(late.error().message, HasSubstr("r00"));
  EXPECT_THAT(editor_->robots_without_agent(), IsEmpty());
  editor_->RevokeSpawn("r00", now_ + 5.0);
  EXPECT_TRUE(run_->world().models.back().removed);
  EXPECT_EQ(run_->frame.edition, 2u);
}

TEST_F(WorldEditorTest, AnAgentInTimeEndsTheWait) {
  MakeEditor();
  const WorldDescription one = test::PlaneWorld(1);
  ASSERT_TRUE(editor_->Apply(Request(ControlCommand::kSpawn, "new", {0.0, 5.0, 0.0, 0.0}), &one, now_).ok());
  editor_->OnJoined({RobotId(2)});
  EXPECT_THAT(editor_->robots_without_agent(), IsEmpty());
  EXPECT_TRUE(editor_->CheckTimeout(now_ + 1000.0).ok());
}

TEST_F(WorldEditorTest, AResetRestoresTheNewestLoadedWorld) {
  MakeEditor();
  const WorldDescription other = test::PlaneWorld(1);
  ASSERT_TRUE(editor_->Apply(Request(ControlCommand::kLoadWorld, ""), &other, now_).ok());
  EXPECT_EQ(run_->world(), other);
  ASSERT_TRUE(editor_->Apply(Request(ControlCommand::kSetPose, "r0", {3.0, 0.0, 0.0, 0.0}), nullptr, now_).ok());
  ASSERT_TRUE(editor_->Apply(Request(ControlCommand::kReset, ""), nullptr, now_).ok());
  EXPECT_EQ(run_->world(), other);
  EXPECT_EQ(run_->frame.state.robots[0].X_WR.x, 0.0);
  EXPECT_EQ(run_->frame.fresh_edition, 3u);
}

}  // namespace
}  // namespace troupe
