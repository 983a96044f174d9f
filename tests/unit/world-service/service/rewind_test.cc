#include "world-service/service/rewind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>

#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "world-service/service/robot_memories.h"

namespace troupe {
namespace {

// A history of which the test sets the outcomes.
class RewindTest : public testing::Test, protected RunHistory {
 protected:
  class States final : public RewindStates {
   public:
    explicit States(RewindTest& test) : test_(test) {}
    Result<bool> MakeSome() override { return test_.made_; }
    Result<RewoundRun> Write() override {
      test_.is_written_ = true;
      if (test_.write_throws_) throw std::runtime_error("the disk is broken");
      RewoundRun run;
      run.frame.edition = test_.started_from_->edition + 1;
      return run;
    }

   private:
    RewindTest& test_;
  };

  RewindTest() {
    FrameMessage newest;
    newest.edition = 4;
    rewind_.Start({}, newest);
  }
  Result<std::vector<HistoryEntry>> Read(const HistoryRequest&) override { return Failure("not asked for"); }
  Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind&, const FrameMessage& newest) override {
    started_from_ = newest;
    return std::unique_ptr<RewindStates>(std::make_unique<States>(*this));
  }
  std::optional<Result<RewoundRun>> WorkAndAdvance(bool run_ends = false) {
    rewind_.Work(*this);
    return rewind_.Advance(run_ends);
  }

  Rewind rewind_;
  std::optional<FrameMessage> started_from_;
  Result<bool> made_ = false;  // whether there are more
  bool write_throws_ = false;
  bool is_written_ = false;
};

TEST_F(RewindTest, WritesOnceAllStatesAreMade) {
  made_ = true;
  EXPECT_FALSE(WorkAndAdvance());
  EXPECT_EQ(rewind_.stage(), Rewind::Stage::kMaking);
  made_ = false;
  EXPECT_FALSE(WorkAndAdvance());
  EXPECT_EQ(rewind_.stage(), Rewind::Stage::kWriting);
  EXPECT_FALSE(is_written_);
  const auto outcome = WorkAndAdvance();
  ASSERT_TRUE(outcome && outcome->ok());
  EXPECT_EQ(outcome->value().frame.edition, 5u);
  EXPECT_FALSE(rewind_.is_running());
}

TEST_F(RewindTest, AnErrorEndsItBeforeAnythingIsWritten) {
  made_ = Failure("a state is missing");
  const auto outcome = WorkAndAdvance();
  ASSERT_TRUE(outcome && !outcome->ok());
  EXPECT_EQ(outcome->error().message, "a state is missing");
  EXPECT_FALSE(rewind_.is_running());
  EXPECT_FALSE(is_written_);
}

TEST_F(RewindTest, TheEndOfTheRunEndsItUnlessItIsWritten) {
  for (const bool has_more : {true, false}) {
    made_ = has_more;
    (void)WorkAndAdvance();
    const auto outcome = rewind_.Advance(true);
    EXPECT_TRUE(outcome && !outcome->ok());
    EXPECT_FALSE(rewind_.is_running());
    rewind_.Start({}, *started_from_);
  }
  EXPECT_FALSE(is_written_);
  (void)WorkAndAdvance();
  const auto written = WorkAndAdvance(true);
  EXPECT_TRUE(written && written->ok());
}

TEST_F(RewindTest, AnExceptionIsItsOutcome) {
  write_throws_ = true;
  (void)WorkAndAdvance();
  const auto outcome = WorkAndAdvance();
  ASSERT_TRUE(outcome && !outcome->ok());
  EXPECT_EQ(outcome->error().message, "the disk is broken");
}

// Requests to a run that is being rewound wait for the end of the rewind, and are open until then.
class RequestsInARewindTest : public test::CoordinatorTest, protected RunHistory {
 protected:
  void Ask(const control::Request& request) {
    coordinator->Control(
        request, [this](const ControlReply& reply) { replies_.push_back(reply); }, now);
  }
  Result<std::vector<HistoryEntry>> Read(const HistoryRequest&) override { return Failure("not asked for"); }
  Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind&, const FrameMessage&) override {
    return Failure("a state cannot be read");
  }

  std::vector<ControlReply> replies_;
};

TEST_F(RequestsInARewindTest, TheyWaitAndAreOpen) {
  options.has_history = true;
  options.start_paused = true;
  MakeAndStart(1);
  ProposalMessage paused = ProposalOf(1, 0.0);
  paused.proposals.clear();
  paused.paused = true;
  coordinator->OnProposal(paused, now);
  Ask(control::Rewind{.tick = 0});
  ASSERT_TRUE(coordinator->rewind().is_running());
  Ask(control::Speed{2.0});
  Ask(control::Pause());
  EXPECT_TRUE(replies_.empty());
  Ask(control::GetStatus());
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_EQ(replies_[0].open_requests, 3u);

  coordinator->rewind().Work(*this);
  coordinator->AdvanceRewind(now);
  ASSERT_EQ(replies_.size(), 4u);
  EXPECT_EQ(replies_[1].problem, "a state cannot be read");
  EXPECT_TRUE(replies_[2].done);
  EXPECT_TRUE(replies_[3].done);
  EXPECT_EQ(replies_[3].open_requests, 0u);
}

// Agents whose robots do not remember the run: they are sent its history before they are admitted.

using test::CoordinatorTest;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

FrameMessage Newest(Edition edition, Tick tick) {
  FrameMessage frame;
  frame.edition = edition;
  frame.state.tick = tick;
  return frame;
}

JoinMessage JoinWith(const std::optional<ControllerCheckpoint>& memory, const std::string& robot = "r0") {
  return {.robots = {robot}, .memory = memory};
}

TEST(RobotMemoriesTest, AtTheFirstStateNothingIsToBeRemembered) {
  const RobotMemories memories;
  EXPECT_EQ(memories.MissingFor(JoinWith({}), Newest(0, 0)), std::nullopt);
}

TEST(RobotMemoriesTest, AMemoryMustReachToTheStateBeforeTheNewest) {
  RobotMemories memories;
  const FrameMessage newest = Newest(0, 7);
  memories.OnStep(newest);
  const ControllerCheckpoint before{0, 6, true};
  EXPECT_EQ(memories.MissingFor(JoinWith({}), newest), HistoryRequest());
  EXPECT_EQ(memories.MissingFor(JoinWith(ControllerCheckpoint{0, 5, true}), newest),
            (HistoryRequest{ControllerCheckpoint{0, 5, true}}));
  EXPECT_EQ(memories.MissingFor(JoinWith(ControllerCheckpoint{0, 6, false}), newest),
            (HistoryRequest{ControllerCheckpoint{0, 6, false}}))
      << "it has not decided on that state";
  EXPECT_EQ(memories.MissingFor(JoinWith(before), newest), std::nullopt);
  EXPECT_EQ(memories.MissingFor(JoinWith(ControllerCheckpoint{0, 7, false}), newest), std::nullopt);
}

TEST(RobotMemoriesTest, RobotsBeginWithTheirWorldOrWhenTheyAreSpawned) {
  RobotMemories memories;
  memories.OnStep(Newest(0, 1));
  memories.OnEdit(Newest(1, 1), 1);
  memories.OnNewRobots({"late"}, 1);
  EXPECT_EQ(memories.MissingFor(JoinWith({}, "late"), Newest(1, 1)), std::nullopt);
  EXPECT_EQ(memories.MissingFor(JoinWith({}), Newest(1, 1)), HistoryRequest());
  EXPECT_EQ(memories.MissingFor(JoinWith(ControllerCheckpoint{0, 1, false}), Newest(1, 1)), std::nullopt);
  memories.OnStep(Newest(1, 2));
  EXPECT_EQ(memories.MissingFor(JoinWith({}, "late"), Newest(1, 2)), (HistoryRequest{{}, 1}));
  memories.OnEdit(Newest(2, 0), 2);
  memories.OnFreshStart(2);
  EXPECT_EQ(memories.MissingFor(JoinWith(ControllerCheckpoint{1, 2, false}), Newest(2, 0)), std::nullopt);
  memories.OnStep(Newest(2, 1));
  EXPECT_EQ(memories.MissingFor(JoinWith(ControllerCheckpoint{1, 2, false}), Newest(2, 1)), (HistoryRequest{{}, 2}))
      << "a memory from before the fresh start is of no use";
}

class MemoryTest : public CoordinatorTest {
 protected:
  // Two robots at tick 3; the agent of the first is lost.
  void LoseFirstAgent(OnAgentLoss policy = OnAgentLoss::kRebuild) {
    options.settings.on_agent_loss = policy;
    options.has_history = true;
    MakeAndStart(2);
    for (int i = 0; i < 3; ++i) {
      Propose(1);
      Propose(2);
    }
    coordinator->OnAgentGone(1, now);
    Propose(2);
    endpoint.admissions.clear();
    ASSERT_EQ(tick(), policy == OnAgentLoss::kFreeze ? 4u : 3u);
  }
  void JoinWithMemory(AgentId agent, const std::optional<ControllerCheckpoint>& memory) {
    JoinMessage join = JoinOf(agent, {"r0"});
    join.memory = memory;
    coordinator->OnJoin(join, now);
  }
};

TEST_F(MemoryTest, AnAgentThatIsBehindIsSentHistoryAndNotAdmitted) {
  LoseFirstAgent();
  JoinWithMemory(7, {});
  JoinWithMemory(7, {});
  JoinWithMemory(8, {});
  EXPECT_THAT(endpoint.admissions, IsEmpty());
  EXPECT_THAT(coordinator->DrainHistoryDemands(now), IsEmpty()) << "others may ask for the same";
  EXPECT_LE(coordinator->NextPoll(), now + 0.02);
  now += 0.02;
  const auto demands = coordinator->DrainHistoryDemands(now);
  ASSERT_THAT(demands, SizeIs(1));
  EXPECT_EQ(demands[0].request, HistoryRequest());
  EXPECT_THAT(demands[0].agents, ElementsAre(7, 8));
  EXPECT_THAT(coordinator->DrainHistoryDemands(now + 1.0), IsEmpty());

  JoinWithMemory(7, ControllerCheckpoint{0, 1, true});
  now += 0.02;
  const auto next = coordinator->DrainHistoryDemands(now);
  ASSERT_THAT(next, SizeIs(1));
  EXPECT_EQ(next[0].after, (ControllerCheckpoint{0, 1, true}));
  JoinWithMemory(7, ControllerCheckpoint{0, 2, true});
  ASSERT_THAT(endpoint.admissions, SizeIs(1));
  EXPECT_TRUE(endpoint.admissions[0].admitted);
  Propose(2);
  ProposalMessage proposal = ProposalOf(7, 1.0);
  proposal.proposals = {{RobotId(0), {1.0, 0.0, 0.0}}};
  coordinator->OnProposal(proposal, now);
  EXPECT_EQ(tick(), 4u);
}

TEST_F(MemoryTest, OnlyRebuildRestoresTheMemoryOfALostAgent) {
  LoseFirstAgent(OnAgentLoss::kFreeze);
  JoinWithMemory(7, {});
  ASSERT_THAT(endpoint.admissions, SizeIs(1));
  EXPECT_TRUE(endpoint.admissions[0].admitted);
}

TEST_F(MemoryTest, ARunDoesNotGiveUpWhileAnAgentLearns) {
  options.start_timeout_seconds = 10.0;
  LoseFirstAgent();
  coordinator->OnAgentGone(2, now);
  for (int i = 0; i < 5; ++i) {
    Wait(8.0);
    JoinWithMemory(7, {});
    ASSERT_EQ(coordinator->phase(), TickCoordinator::Phase::kRunning);
  }
  Wait(10.5);
  EXPECT_EQ(coordinator->error().error().message, "every agent is lost, and none has rejoined");
}

TEST_F(MemoryTest, AnAgentThatMayNotJoinIsRefusedAtOnce) {
  LoseFirstAgent();
  JoinMessage join = JoinOf(7, {"missing"});
  coordinator->OnJoin(join, now);
  ASSERT_THAT(endpoint.admissions, SizeIs(1));
  EXPECT_FALSE(endpoint.admissions[0].admitted);
  EXPECT_THAT(coordinator->DrainHistoryDemands(now + 1.0), IsEmpty());
}

}  // namespace
}  // namespace troupe
