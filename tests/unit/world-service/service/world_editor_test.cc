#include "world-service/service/world_editor.h"

#include <gmock/gmock.h>

#include <optional>
#include <vector>

#include "common/model/states.h"
#include "tests/support/values.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "tests/unit/world-service/service/live_run_fixture.h"
#include "world-service/core/step.h"
#include "world-service/service/apply_edit.h"

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
  std::optional<WorldEditor> editor_;
};

TEST_F(WorldEditorTest, AnEditBeginsAnEditionAndPauses) {
  MakeEditor();
  ASSERT_TRUE(editor_->Apply(control::SetPose{.name = "r0", .pose = {3.0, 0.0, 0.0, 0.0}}, {}, now_).ok());
  const FrameMessage& frame = endpoint_.frames.back();
  EXPECT_EQ(frame.edition, 1u);
  EXPECT_EQ(frame.world_edition, 0u);  // the description is the same
  EXPECT_TRUE(frame.paused);
  EXPECT_EQ(frame.state.robots[0].X_WR.x, 3.0);
  EXPECT_THAT(run_->notices.Drain(), ElementsAre("tick 0: the pose of 'r0' is set"));
}

TEST_F(WorldEditorTest, AnErrorChangesNothing) {
  MakeEditor();
  const Result<control::Request> applied = editor_->Apply(control::Delete{.name = "r7"}, {}, now_);
  ASSERT_FALSE(applied.ok());
  EXPECT_THAT(applied.error().message, HasSubstr("no entity 'r7'"));
  EXPECT_EQ(endpoint_.frames.size(), 1u);
  EXPECT_EQ(run_->frame.edition, 0u);
  EXPECT_THAT(run_->notices.Drain(), IsEmpty());
}

TEST_F(WorldEditorTest, KeepsDeletedEntitiesForARestoration) {
  MakeEditor();
  EXPECT_FALSE(editor_->Deleted("r0").ok());
  ASSERT_TRUE(editor_->Apply(control::Delete{.name = "r0"}, {}, now_).ok());
  const auto deleted = test::ValueOf(editor_->Deleted("r0"));
  control::Spawn spawn{.name = "again", .pose = {0.0, 5.0, 0.0, 0.0}};
  ASSERT_TRUE(editor_->Apply(spawn, {deleted}, now_).ok());
  EXPECT_EQ(run_->world().robots.back().name, "again");
  EXPECT_EQ(run_->world().robots.back().drive, run_->world().robots.front().drive);
}

TEST_F(WorldEditorTest, ASpawnedRobotHasTheFirstFreeRosDomainOfItsRule) {
  options_.check_world = [](const WorldDescription& world) {
    for (const RobotDescription& robot : world.robots) {
      if (robot.ros.domain == 11u) return Status(Error{{}, "found domain 11"});
    }
    return Status();
  };
  MakeEditor();
  WorldDescription one = test::PlaneWorld(1);
  const auto spawn = [&](const std::string& name, double y, std::uint32_t from) {
    const control::Spawn request{.name = name, .pose = {0.0, y, 0.0, 0.0}};
    return editor_->Apply(request, {std::make_shared<const WorldDescription>(one), from}, now_);
  };
  ASSERT_TRUE(spawn("a", 5.0, 10).ok());
  ASSERT_TRUE(spawn("b", -5.0, 10).ok());
  EXPECT_EQ(run_->world().robots[2].ros.domain, 10u);
  EXPECT_EQ(run_->world().robots[3].ros.domain, 12u) << "the run cannot have 11";
  ASSERT_TRUE(editor_->Apply(control::Delete{.name = "a"}, {}, now_).ok());
  ASSERT_TRUE(spawn("c", 5.0, 10).ok());
  EXPECT_EQ(run_->world().robots[4].ros.domain, 10u) << "that of a deleted robot";
  ASSERT_TRUE(spawn("d", -15.0, 230).ok());
  EXPECT_THAT(spawn("e", -25.0, 230).error().message, HasSubstr("found no free ROS domain from 230 to 230"));

  one.robots[0].ros.domain = 60;
  ASSERT_TRUE(spawn("f", -35.0, 10).ok());
  EXPECT_EQ(run_->world().robots.back().ros.domain, 60u) << "its file's";
  one.robots[0].ros.domain = 11;
  EXPECT_EQ(spawn("g", -45.0, 10).error().message, "found domain 11");
  EXPECT_EQ(run_->world().robots.back().name, "f");
}

TEST_F(WorldEditorTest, ASpawnedRobotNeedsAnAgentInTime) {
  options_.start_timeout_seconds = 5.0;
  MakeEditor();
  const WorldDescription one = test::PlaneWorld(1);
  control::Spawn spawn{.name = "r0", .pose = {0.0, 5.0, 0.0, 0.0}};
  spawn.rename = true;
  const control::Request applied =
      test::ValueOf(editor_->Apply(spawn, {std::make_shared<const WorldDescription>(one)}, now_));
  EXPECT_EQ(std::get<control::Spawn>(applied).name, "r00");
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
  ASSERT_TRUE(editor_
                  ->Apply(control::Spawn{.name = "new", .pose = {0.0, 5.0, 0.0, 0.0}},
                          {std::make_shared<const WorldDescription>(one)}, now_)
                  .ok());
  editor_->OnJoined({RobotId(2)});
  EXPECT_THAT(editor_->robots_without_agent(), IsEmpty());
  EXPECT_TRUE(editor_->CheckTimeout(now_ + 1000.0).ok());
}

TEST_F(WorldEditorTest, AResetRestoresTheNewestLoadedWorld) {
  MakeEditor();
  const WorldDescription other = test::PlaneWorld(1);
  ASSERT_TRUE(editor_->Apply(control::LoadWorld(), {std::make_shared<const WorldDescription>(other)}, now_).ok());
  EXPECT_EQ(run_->world(), other);
  ASSERT_TRUE(editor_->Apply(control::SetPose{.name = "r0", .pose = {3.0, 0.0, 0.0, 0.0}}, {}, now_).ok());
  ASSERT_TRUE(editor_->Apply(control::Reset(), {}, now_).ok());
  EXPECT_EQ(run_->world(), other);
  EXPECT_EQ(run_->frame.state.robots[0].X_WR.x, 0.0);
  EXPECT_EQ(run_->frame.fresh_edition, 3u);
}

// The inputs that observers receive determine a run: a log of them, applied again, gives the same hashes.

// A log of the inputs of a run, as a recording keeps them.
class InputLog final : public RunObserver {
 public:
  struct Entry {
    std::vector<Proposal> proposals;
    std::optional<control::Request> edit;
    std::optional<WorldDescription> world;
    Tick tick = 0;
    std::uint64_t hash = 0;
  };

  Status OnTick(const CommittedTick& tick) override {
    Entry entry;
    entry.proposals.assign(tick.proposals.begin(), tick.proposals.end());
    if (tick.edit != nullptr) {
      entry.edit = tick.edit->request;
      if (tick.edit->world != nullptr) entry.world = *tick.edit->world;
    }
    entry.tick = tick.frame.state.tick;
    entry.hash = tick.frame.state_hash;
    entries.push_back(std::move(entry));
    return Status();
  }

  std::vector<Entry> entries;
};

// The hashes of a log's frames, computed from its inputs alone.
std::vector<std::uint64_t> Replay(const WorldDescription& world, const std::vector<InputLog::Entry>& entries) {
  auto scene = std::make_shared<const Scene>(world);
  std::shared_ptr<const Scene> original = scene;
  WorldState state = InitialState(*scene);
  std::vector<std::uint64_t> hashes;
  for (const InputLog::Entry& entry : entries) {
    if (entry.edit) {
      const AppliedEdit edit{*entry.edit, entry.world ? &*entry.world : nullptr};
      Result<EditedWorld> edited = ApplyEdit(edit, original, scene, state);
      EXPECT_TRUE(edited.ok());
      if (!edited.ok()) return hashes;
      scene = edited.value().scene;
      state = std::move(edited.value().state);
      if (control::Is<control::LoadWorld>(*entry.edit)) original = scene;
    } else if (!hashes.empty()) {
      state = Step(*scene, state, entry.proposals).state;
    }
    hashes.push_back(StateHash(state));
  }
  return hashes;
}

class ApplyEditTest : public test::CoordinatorTest {
 protected:
  void Edit(const control::Request& request, RequestedWorld world = {}) {
    coordinator->Control(
        request, [this](const ControlReply& reply) { done_.push_back(reply.done); }, now, std::move(world));
  }
  // All agents answer the newest frame.
  void AnswerAll(std::size_t robots) {
    std::vector<ProposalMessage> answers;
    for (AgentId agent = 1; agent <= robots; ++agent) {
      answers.push_back(ProposalOf(agent, static_cast<double>(agent)));
      answers.back().paused = endpoint.frames.back().paused;
      if (answers.back().paused) answers.back().proposals.clear();
    }
    for (const ProposalMessage& answer : answers) coordinator->OnProposal(answer, now);
  }

  InputLog log_;
  std::vector<bool> done_;
};

TEST_F(ApplyEditTest, ALogOfInputsGivesTheHashesOfTheRun) {
  observers = {&log_};
  options.start_timeout_seconds = 5.0;
  options.start_paused = true;
  MakeAndStart(2);
  Edit(control::SetPose{"r0", {0.0, 3.0, 0.0, 0.5}});  // at tick 0
  for (int i = 0; i < 2; ++i) AnswerAll(2);
  control::Play play;
  coordinator->Control(
      play, [](const ControlReply&) {}, now);
  for (int i = 0; i < 3; ++i) AnswerAll(2);
  Edit(control::Spawn{.name = "r0", .pose = {0.0, -5.0, 0.0, 0.0}, .rename = true},
       {std::make_shared<const WorldDescription>(test::PlaneWorld(1))});
  for (int i = 0; i < 3; ++i) AnswerAll(2);
  Wait(6.0);  // no agent joins for the new robot, and the spawn is revoked
  for (int i = 0; i < 3; ++i) AnswerAll(2);
  Edit(control::Delete{"r1"});
  for (int i = 0; i < 4; ++i) AnswerAll(2);
  Edit(control::Reset());
  for (int i = 0; i < 4; ++i) AnswerAll(2);

  std::vector<std::uint64_t> hashes;
  std::size_t edits = 0;
  for (const InputLog::Entry& entry : log_.entries) {
    hashes.push_back(entry.hash);
    edits += entry.edit.has_value();
  }
  EXPECT_EQ(edits, 5u);
  EXPECT_GT(hashes.size(), edits + 6);
  EXPECT_EQ(Replay(scene->world(), log_.entries), hashes);
}

TEST_F(ApplyEditTest, RefusesBadScopesAndMissingWorlds) {
  const auto plane = std::make_shared<const Scene>(test::PlaneWorld(1));
  const WorldState state = InitialState(*plane);
  for (const std::uint8_t scopes : {0, 8, 254}) {
    control::Reset request{.scopes = scopes};
    EXPECT_FALSE(ApplyEdit({request}, plane, plane, state).ok());
  }
  EXPECT_FALSE(ApplyEdit({control::Spawn{.name = "r9"}}, plane, plane, state).ok());
  EXPECT_FALSE(ApplyEdit({control::LoadWorld()}, plane, plane, state).ok());
}

}  // namespace
}  // namespace troupe
