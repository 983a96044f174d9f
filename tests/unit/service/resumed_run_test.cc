// A coordinator that continues a run from its newest state.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/service/coordinator_fixture.h"

namespace troupe {
namespace {

using test::CoordinatorTest;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Phase = TickCoordinator::Phase;

// Keeps what another coordinator needs to continue the run.
class KeptJournal final : public RunObserver {
 public:
  Status OnCommit(const CommittedTick& tick, const RunProgress& newest) override {
    frame = tick.frame;
    frame->commands.clear();  // of the tick to come, which a journal does not have
    return OnProgress(newest);
  }
  Status OnProgress(const RunProgress& newest) override {
    progress = newest;
    return {};
  }

  std::optional<FrameMessage> frame;
  RunProgress progress;
};

class ResumedRunTest : public CoordinatorTest {
 protected:
  ResumedRunTest() { observers = {&journal_}; }

  // The service dies, and another one continues: without any agent.
  void Resume() {
    ResumedRun resumed{.run = kRun, .incarnation = journal_.progress.incarnation + 1};
    resumed.original = resumed.scene = scene;
    resumed.frame = journal_.frame;
    resumed.progress = journal_.progress;
    resumed.next_number = ++next_number_;
    options.resumed = resumed;
    options.incarnation = resumed.incarnation;
    endpoint = {};
    coordinator.emplace(scene, options, endpoint, observers, now);
    coordinator->Announce();
  }
  void Rejoin(AgentId agent, Incarnation incarnation = 1) {
    JoinMessage join = JoinOf(agent, {"r" + std::to_string(agent - 1)});
    join.incarnation = incarnation;
    coordinator->OnJoin(join, now);
  }
  void ProposeAs(Incarnation incarnation, AgentId agent) {
    ProposalMessage proposal = ProposalOf(agent, 1.0);
    proposal.incarnation = incarnation;
    coordinator->OnProposal(proposal, now);
  }

  std::uint64_t next_number_ = 0;
  KeptJournal journal_;
};

TEST_F(ResumedRunTest, BeginsWithTheNewestFrameWhenAllAgentsAreBack) {
  MakeAndStart(2);
  Propose(1);
  Propose(2);
  const FrameMessage newest = endpoint.frames.back();
  Resume();
  EXPECT_TRUE(endpoint.sessions.back().begun);
  EXPECT_EQ(endpoint.sessions.back().incarnation, 1u);
  Rejoin(1);
  EXPECT_THAT(endpoint.frames, IsEmpty());
  Rejoin(2);
  ASSERT_EQ(endpoint.frames.size(), 1u);
  EXPECT_EQ(endpoint.frames.back().state, newest.state);
  EXPECT_EQ(endpoint.frames.back().state_hash, newest.state_hash);
  ProposeAs(1, 1);
  ProposeAs(1, 2);
  EXPECT_EQ(tick(), 2u);
  EXPECT_NEAR(Travel(0), 0.2, 1e-12);
}

TEST_F(ResumedRunTest, IgnoresMessagesForTheServiceBefore) {
  MakeAndStart(1);
  Resume();
  Rejoin(1, 0);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  Rejoin(1);
  ASSERT_EQ(coordinator->phase(), Phase::kRunning);
  ProposeAs(0, 1);
  EXPECT_EQ(tick(), 0u);
  ProposeAs(1, 1);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(ResumedRunTest, HasTheCommandsInForce) {
  ControlRequest request;
  request.command = ControlCommand::kCommandRobot;
  request.ticks = 3;
  MakeAndStart(2);
  request.name = "r0";
  request.robot_command.twist = Twist{0.5, 0.0, 0.0};
  ASSERT_TRUE(Ask(request).done);
  Propose(1);
  Propose(2);
  request.name = "r1";
  ASSERT_TRUE(Ask(request).done) << "it arrives after the newest frame was sent";
  const std::vector<RobotCommand> sent = endpoint.frames.back().commands;
  ASSERT_EQ(sent.size(), 1u);
  Resume();
  Rejoin(1);
  Rejoin(2);
  ASSERT_FALSE(endpoint.frames.empty());
  EXPECT_EQ(endpoint.frames.back().commands, sent) << "an agent may have answered this frame";
  std::vector<std::size_t> counts;
  for (int i = 0; i < 4; ++i) {
    ProposeAs(1, 1);
    ProposeAs(1, 2);
    counts.push_back(endpoint.frames.back().commands.size());
  }
  EXPECT_THAT(counts, ::testing::ElementsAre(2u, 2u, 1u, 0u));
}

TEST_F(ResumedRunTest, HasTheSpeedThatWasSet) {
  ControlRequest request;
  request.command = ControlCommand::kSpeed;
  request.speed = 0.25;
  MakeAndStart(1);
  EXPECT_EQ(coordinator->MakeStatus(now).speed, std::nullopt);
  ASSERT_TRUE(Ask(request).done);
  Resume();
  EXPECT_EQ(coordinator->MakeStatus(now).speed, 0.25);
  Rejoin(1);
  request.speed.reset();
  ASSERT_TRUE(Ask(request).done);
  options.settings.speed = 2.0;
  Resume();
  EXPECT_EQ(coordinator->MakeStatus(now).speed, std::nullopt);
}

TEST_F(ResumedRunTest, ANewGoalHasAnotherNumberThanThoseBefore) {
  const auto next_goal = [this](Incarnation incarnation) {
    ControlRequest request{.command = ControlCommand::kCommandRobot, .ticks = 10, .name = "r0"};
    request.robot_command.goal = Goal{0, {{1.0, 2.0}}};
    EXPECT_TRUE(Ask(request).done);
    ProposeAs(incarnation, 1);
    return endpoint.frames.back().commands.at(0).goal->number;
  };
  Make(1);
  JoinMessage join = JoinOf(1, {"r0"});
  join.accept_goals = {"r0"};
  coordinator->OnJoin(join, now);
  const std::uint32_t before = next_goal(0);
  Resume();
  join.incarnation = 1;
  coordinator->OnJoin(join, now);
  EXPECT_NE(next_goal(1), before);
}

TEST_F(ResumedRunTest, IsPausedIfTheRunWas) {
  MakeAndStart(1);
  ControlRequest pause;
  pause.command = ControlCommand::kPause;
  coordinator->Control(
      pause, [](const ControlReply&) {}, now);
  Propose(1);
  ASSERT_TRUE(endpoint.frames.back().paused);
  Resume();
  Rejoin(1);
  EXPECT_TRUE(endpoint.frames.back().paused);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(ResumedRunTest, FinishesAStep) {
  options.start_paused = true;
  MakeAndStart(1);
  ProposalMessage paused = ProposalOf(1, 0.0);
  paused.proposals.clear();
  paused.paused = true;
  coordinator->OnProposal(paused, now);
  ControlRequest step{.command = ControlCommand::kStep, .ticks = 3};
  coordinator->Control(
      step, [](const ControlReply&) {}, now);
  Propose(1);
  ASSERT_EQ(tick(), 1u);
  Resume();
  Rejoin(1);
  ProposeAs(1, 1);
  EXPECT_FALSE(endpoint.frames.back().paused);
  ProposeAs(1, 1);
  EXPECT_TRUE(endpoint.frames.back().paused);
  EXPECT_EQ(tick(), 3u);
}

TEST_F(ResumedRunTest, DoesNotWaitForARobotThatHadLostItsAgent) {
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  Propose(1);
  ASSERT_EQ(tick(), 1u);
  Resume();
  Rejoin(1);
  EXPECT_EQ(coordinator->phase(), Phase::kRunning);
}

TEST_F(ResumedRunTest, LosesAgentsThatDoNotReturn) {
  MakeAndStart(2);
  Resume();
  Rejoin(1);
  Wait(options.settings.agent_deadline_seconds - 1.0);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  EXPECT_GT(endpoint.sessions.size(), 1u) << "it is announced again";
  Wait(1.5);
  EXPECT_EQ(coordinator->phase(), Phase::kRunning);
  EXPECT_THAT(Events(), testing::Contains("left r1"));
  ProposeAs(1, 1);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(ResumedRunTest, EndsARunWhoseLastTickWasCommitted) {
  options.settings.ticks = 1;
  MakeAndStart(1);
  Propose(1);
  ASSERT_TRUE(endpoint.frames.back().last);
  Resume();
  Rejoin(1);
  ASSERT_FALSE(endpoint.frames.empty());
  EXPECT_TRUE(endpoint.frames.back().last);
  EXPECT_EQ(coordinator->phase(), Phase::kEnding);
  // Its agents may have left before.
  Resume();
  Wait(2.0 * options.lease_seconds + 0.1);
  Wait(1.1);
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
  EXPECT_TRUE(coordinator->error().ok());
}

TEST_F(ResumedRunTest, OfTwoServicesOfARunTheEarlierOneStops) {
  MakeAndStart(1);
  SessionMessage other{.run = kRun, .host = "there", .incarnation = 1};
  coordinator->OnRivalService(other, now);
  EXPECT_THAT(coordinator->error().error().message,
              HasSubstr("another world service (there, pid 0) continues this run"));
  Propose(1);
  EXPECT_EQ(tick(), 0u);

  Resume();
  Rejoin(1);
  const std::size_t sessions = endpoint.sessions.size();
  other.incarnation = 0;
  coordinator->OnRivalService(other, now);
  EXPECT_TRUE(coordinator->error().ok());
  EXPECT_EQ(endpoint.sessions.size(), sessions + 1) << "the other one is told";
}

}  // namespace
}  // namespace troupe
