// The inputs that observers are told determine a run: a log of them, applied again, gives the same hashes.
#include "world-service/service/apply_edit.h"

#include <optional>
#include <vector>

#include "common/model/states.h"
#include "tests/unit/service/coordinator_fixture.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

// A log of the inputs of a run, as a recording keeps them.
class InputLog final : public RunObserver {
 public:
  struct Entry {
    std::vector<Proposal> proposals;
    std::optional<ControlRequest> edit;
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
      if (entry.edit->command == ControlCommand::kLoadWorld) original = scene;
    } else if (!hashes.empty()) {
      state = Step(*scene, state, entry.proposals).state;
    }
    hashes.push_back(StateHash(state));
  }
  return hashes;
}

class ApplyEditTest : public test::CoordinatorTest {
 protected:
  void Edit(ControlCommand command, const std::string& name, const Pose& pose = {}, RequestedWorld world = nullptr) {
    ControlRequest request{.command = command, .name = name, .pose = pose, .rename = true};
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
  Edit(ControlCommand::kSetPose, "r0", {0.0, 3.0, 0.0, 0.5});  // at tick 0
  for (int i = 0; i < 2; ++i) AnswerAll(2);
  ControlRequest play;
  play.command = ControlCommand::kPlay;
  coordinator->Control(
      play, [](const ControlReply&) {}, now);
  for (int i = 0; i < 3; ++i) AnswerAll(2);
  Edit(ControlCommand::kSpawn, "r0", {0.0, -5.0, 0.0, 0.0},
       std::make_shared<const WorldDescription>(test::PlaneWorld(1)));
  for (int i = 0; i < 3; ++i) AnswerAll(2);
  Wait(6.0);  // no agent joins for the new robot, and the spawn is revoked
  for (int i = 0; i < 3; ++i) AnswerAll(2);
  Edit(ControlCommand::kDelete, "r1");
  for (int i = 0; i < 4; ++i) AnswerAll(2);
  Edit(ControlCommand::kReset, "");
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
    ControlRequest request{.command = ControlCommand::kReset, .scopes = scopes};
    EXPECT_FALSE(ApplyEdit({request}, plane, plane, state).ok());
  }
  for (const ControlCommand command : {ControlCommand::kSpawn, ControlCommand::kLoadWorld}) {
    ControlRequest request;
    request.command = command;
    EXPECT_FALSE(ApplyEdit({request}, plane, plane, state).ok());
  }
}

}  // namespace
}  // namespace troupe
