// Loss and return of agents, by the settings of the run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/world-service/service/coordinator_fixture.h"

namespace troupe {
namespace {

using test::CoordinatorTest;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Phase = TickCoordinator::Phase;

class LossTest : public CoordinatorTest {
 protected:
  // A whole tick.
  void ProposeAll(AgentId agents) {
    for (AgentId agent = 1; agent <= agents; ++agent) Propose(agent);
  }
};

TEST_F(LossTest, FreezeContinuesWithTheOthers) {
  MakeAndStart(2);
  Propose(1);
  coordinator->OnAgentGone(2, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(Travel(1), 0.0);
  EXPECT_THAT(Events(), ElementsAre("left r1"));
  ASSERT_EQ(endpoint.frames.back().events.size(), 1u);
  EXPECT_EQ(endpoint.frames.back().events[0].type, EventType::kLeft);
  EXPECT_EQ(endpoint.frames.back().events[0].tick, 1u);
  Propose(1);
  EXPECT_EQ(tick(), 2u);
  EXPECT_NEAR(Travel(0), 0.2, 1e-12);
}

TEST_F(LossTest, SummaryNamesTheRobotsWithoutAgents) {
  options.settings.ticks = 1;
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  Propose(1);
  EXPECT_THAT(coordinator->MakeSummary().lost, ElementsAre("r1"));
}

TEST_F(LossTest, FreezeWaitsWhenNoAgentIsLeft) {
  MakeAndStart(1);
  coordinator->OnAgentGone(1, now);
  Wait(1.0);
  EXPECT_EQ(tick(), 0u);
  EXPECT_THAT(coordinator->MakeStatus(now).waiting_for, ElementsAre("r0"));
  Join(11, {"r0"});
  Propose(1);  // of a lost agent
  EXPECT_EQ(tick(), 0u);
  coordinator->OnProposal({kRun, 11, 1, {{RobotId(0), {1.0, 0, 0}}}, {}}, now);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(LossTest, FailsWhenNoAgentIsLeftAndNoneRejoins) {
  options.start_timeout_seconds = 10.0;
  MakeAndStart(1);
  coordinator->OnAgentGone(1, now);
  Wait(9.0);
  EXPECT_TRUE(coordinator->error().ok());
  Wait(2.0);
  ASSERT_FALSE(coordinator->error().ok());
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
}

TEST_F(LossTest, PauseWaitsForTheRobotAndNamesIt) {
  options.settings.on_agent_loss = OnAgentLoss::kPause;
  MakeAndStart(2);
  Propose(1);
  coordinator->OnAgentGone(2, now);
  Wait(100.0);
  EXPECT_EQ(tick(), 0u);
  EXPECT_THAT(coordinator->MakeStatus(now).waiting_for, ElementsAre("r1"));
  EXPECT_EQ(frames(), 2u);  // resent once in a while, for a lost agent that lives
  EXPECT_THAT(endpoint.frames.back().awaited, ElementsAre(2));

  Join(12, {"r1"});
  EXPECT_EQ(frames(), 3u);  // for the new agent
  coordinator->OnProposal({kRun, 12, 1, {{RobotId(1), {1.0, 0, 0}}}, {}}, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_NEAR(Travel(1), 0.1, 1e-12);
}

TEST_F(LossTest, AbortFailsTheRunWithAReason) {
  options.settings.on_agent_loss = OnAgentLoss::kAbort;
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  ASSERT_FALSE(coordinator->error().ok());
  EXPECT_THAT(coordinator->error().error().message, HasSubstr("r1 (host2, pid 2)"));
  EXPECT_TRUE(endpoint.frames.back().last);
  EXPECT_EQ(coordinator->phase(), Phase::kEnding);
}

TEST_F(LossTest, ASilentAgentIsLostAtTheDeadline) {
  options.settings.agent_deadline_seconds = 3.0;
  MakeAndStart(2);
  ProposeAll(2);
  Propose(1);
  Wait(2.9);
  EXPECT_EQ(tick(), 1u);
  Wait(0.2);
  EXPECT_EQ(tick(), 2u);
  EXPECT_THAT(Events(), ElementsAre("left r1"));
}

// A network that does not pass frames on has lost no agent: a tick without them would be another run.
TEST_F(LossTest, NoAgentIsLostBeforeAllHaveAnsweredTheFirstFrame) {
  options.settings.agent_deadline_seconds = 3.0;
  options.advice_on_silence = "expected multicast";
  MakeAndStart(3);
  Propose(1);
  for (int i = 0; i < 11; ++i) Wait(5.0);
  EXPECT_EQ(tick(), 0u);
  EXPECT_EQ(coordinator->present_agents(), 3u);
  EXPECT_THAT(Events(), IsEmpty());
  EXPECT_THAT(coordinator->DrainNotices(),
              ElementsAre(AllOf(HasSubstr("r1"), HasSubstr("host2"), HasSubstr("expected multicast"))));
  Wait(5.1);
  ASSERT_FALSE(coordinator->error().ok());
  EXPECT_THAT(coordinator->error().error().message, AllOf(HasSubstr("r1, r2"), HasSubstr("expected multicast")));
  EXPECT_EQ(tick(), 0u);
}

TEST_F(LossTest, AnswersThatArriveOneAfterAnotherLoseNone) {
  options.settings.agent_deadline_seconds = 3.0;
  MakeAndStart(3);
  ProposeAll(3);
  for (AgentId agent = 1; agent <= 3; ++agent) {
    Wait(2.5);  // over a slow link
    Propose(agent);
  }
  EXPECT_EQ(tick(), 2u);
  EXPECT_THAT(Events(), IsEmpty());
}

TEST_F(LossTest, SeveralSilentAgentsAreLostAtOnce) {
  options.settings.agent_deadline_seconds = 3.0;
  MakeAndStart(3);
  ProposeAll(3);
  Propose(1);
  Wait(3.1);
  EXPECT_EQ(tick(), 2u);
  EXPECT_THAT(Events(), ElementsAre("left r1", "left r2"));
}

TEST_F(LossTest, WithoutADeadlineASilentAgentIsWaitedForAndNamed) {
  MakeAndStart(2);
  ProposeAll(2);
  Propose(1);
  Wait(4.9);
  EXPECT_THAT(coordinator->DrainNotices(), IsEmpty());
  Wait(0.2);
  EXPECT_THAT(coordinator->DrainNotices(),
              ElementsAre(AllOf(HasSubstr("tick 2 waits for the agents of r1 (host2, pid 2)"), HasSubstr("5 s"))));
  for (int i = 0; i < 100; ++i) Wait(1.0);
  EXPECT_THAT(coordinator->DrainNotices(), SizeIs(3));  // once in a while
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(coordinator->present_agents(), 2u);
  Propose(2);
  EXPECT_EQ(tick(), 2u);
  EXPECT_EQ(coordinator->MakeSummary().frozen, 0u);
}

// A process that was stopped, or that a machine with too much work has starved.
TEST_F(LossTest, AnAgentThatALauncherWatchesIsLostByItsEndAlone) {
  MakeAndStart(3);
  ProposeAll(3);
  coordinator->OnAgentNews({.agent = 2}, now);
  Propose(1);
  coordinator->OnAgentSilent(2, now);
  coordinator->OnAgentSilent(3, now);
  EXPECT_THAT(Events(), ElementsAre("left r2"));
  Propose(2);
  EXPECT_EQ(tick(), 2u);
  coordinator->OnAgentNews({.agent = 2, .end = "its process was killed"}, now);
  Propose(1);
  ASSERT_EQ(tick(), 3u);
  ASSERT_THAT(endpoint.frames.back().events, SizeIs(1));
  EXPECT_EQ(endpoint.frames.back().events[0].detail, "host2, pid 2: its process was killed");
}

TEST_F(LossTest, TheLeaseThatAUserGivesIsTheLimitOfProcessesThatLive) {
  options.lease_is_limit = true;
  MakeAndStart(2);
  coordinator->OnAgentNews({.agent = 2}, now);
  coordinator->OnAgentSilent(2, now);
  EXPECT_THAT(Events(), ElementsAre("left r1"));
}

TEST_F(LossTest, TheSummaryCountsTheRobotsThatHadNoAgentInATick) {
  MakeAndStart(3);
  ProposeAll(3);
  coordinator->OnAgentGone(2, now);
  Join(2);  // before the next tick
  ProposeAll(3);
  EXPECT_EQ(coordinator->MakeSummary().frozen, 0u);
  coordinator->OnAgentGone(3, now);
  Propose(1);
  Propose(2);
  Join(3);
  ProposeAll(3);
  EXPECT_EQ(coordinator->MakeSummary().frozen, 1u);
  EXPECT_THAT(coordinator->MakeSummary().lost, IsEmpty());
}

TEST_F(LossTest, TheEndWaitsAsLongAsAgentsLeave) {
  options.settings.ticks = 1;
  MakeAndStart(3);
  ProposeAll(3);
  for (const AgentId agent : {AgentId{1}, AgentId{2}, AgentId{3}}) {
    EXPECT_EQ(coordinator->phase(), Phase::kEnding);
    Wait(4.0);
    coordinator->OnAgentGone(agent, now);
  }
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
}

TEST_F(LossTest, ALostAgentThatAnswersAgainRejoins) {
  options.settings.agent_deadline_seconds = 3.0;
  MakeAndStart(2);
  ProposeAll(2);
  Propose(1);
  Wait(3.1);
  ASSERT_EQ(tick(), 2u);
  Events();
  coordinator->OnProposal(ProposalOf(2, 1.0, 2), now);  // too late for its tick
  EXPECT_THAT(Events(), IsEmpty());
  Propose(2);
  EXPECT_THAT(Events(), ElementsAre("joined r1"));
  EXPECT_EQ(tick(), 2u);
  Propose(1);
  EXPECT_EQ(tick(), 3u);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
}

TEST_F(LossTest, AnAgentThatIsGoneRejoinsOnlyByAJoin) {
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  Events();
  endpoint.admissions.clear();
  Propose(2);  // sent before its end, or the agent does not know that it is lost
  EXPECT_THAT(Events(), IsEmpty());
  EXPECT_EQ(coordinator->present_agents(), 1u);
  ASSERT_EQ(endpoint.admissions.size(), 1u);
  EXPECT_EQ(endpoint.admissions.back(), (AdmissionMessage{kRun, 2, false, ""}));
  Join(2);
  EXPECT_TRUE(endpoint.admissions.back().admitted);
  EXPECT_THAT(Events(), ElementsAre("joined r1"));
}

TEST_F(LossTest, AnAgentThatIsGoneAfterItsSilenceRejoinsOnlyByAJoin) {
  options.settings.agent_deadline_seconds = 3.0;
  MakeAndStart(2);
  ProposeAll(2);
  Propose(1);
  Wait(3.1);
  coordinator->OnAgentGone(2, now);
  Events();
  Propose(2);
  EXPECT_EQ(coordinator->present_agents(), 1u);
}

TEST_F(LossTest, AHaltedRunResendsItsFrameToTheLostAgents) {
  options.settings.on_agent_loss = OnAgentLoss::kPause;
  MakeAndStart(2);
  Propose(1);
  coordinator->OnAgentGone(2, now);
  const std::size_t sent = frames();
  for (int i = 0; i < 10; ++i) Wait(coordinator->NextPoll() - now);
  EXPECT_EQ(frames(), sent + 10);
  EXPECT_THAT(endpoint.frames.back().awaited, ElementsAre(2));
}

TEST_F(LossTest, AHaltedRunResendsItsFrameInAPauseToo) {
  options.settings.on_agent_loss = OnAgentLoss::kRebuild;
  options.start_paused = true;
  MakeAndStart(2);
  for (const AgentId agent : {AgentId{1}, AgentId{2}}) {
    ProposalMessage answer = ProposalOf(agent, 0.0);
    answer.paused = true;
    coordinator->OnProposal(answer, now);
  }
  coordinator->OnAgentGone(2, now);
  const std::size_t sent = frames();
  for (int i = 0; i < 10; ++i) Wait(coordinator->NextPoll() - now);
  EXPECT_EQ(frames(), sent + 10);
  EXPECT_THAT(endpoint.frames.back().awaited, ElementsAre(2));
}

TEST_F(LossTest, AnotherAgentMayJoinForALostRobot) {
  MakeAndStart(2);
  Propose(1);
  coordinator->OnAgentGone(2, now);
  for (int i = 0; i < 5; ++i) Propose(1);
  const Tick joined_at = tick();
  Events();
  Join(12, {"r1"});
  EXPECT_TRUE(endpoint.admissions.back().admitted);
  EXPECT_THAT(Events(), ElementsAre("joined r1"));
  EXPECT_EQ(tick(), joined_at);  // the frame is resent, for the new agent
  Propose(1);
  EXPECT_EQ(tick(), joined_at);  // the barrier waits for it
  coordinator->OnProposal({kRun, 12, joined_at + 1, {{RobotId(1), {1.0, 0, 0}}}, {}}, now);
  EXPECT_EQ(tick(), joined_at + 1);
  EXPECT_NEAR(Travel(1), 0.1, 1e-12);
  // The old agent, which lost the robot, has no influence any more, and is asked to join again.
  Propose(2);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected"));
  EXPECT_EQ(endpoint.admissions.back(), (AdmissionMessage{kRun, 2, false, ""}));
}

TEST_F(LossTest, OfManyUnknownAgentsAFewAreAskedToJoinAgain) {
  MakeAndStart(1);
  endpoint.admissions.clear();
  for (AgentId agent = 100; agent < 200; ++agent) {
    coordinator->OnProposal({kRun, agent, 1, {}, {}}, now);
  }
  EXPECT_EQ(endpoint.admissions.size(), 10u);
}

TEST_F(LossTest, TheSilenceOfAnAgentCountsFromTheStartOfTheRunNotFromItsJoin) {
  Make(2);
  Join(1);
  now += 30.0;
  Join(2);
  ASSERT_EQ(coordinator->phase(), Phase::kRunning);
  Wait(59.9);
  EXPECT_TRUE(coordinator->error().ok());
  Wait(0.2);
  EXPECT_FALSE(coordinator->error().ok());
}

TEST_F(LossTest, ANewAgentHasTheWholeDeadlineHoweverLongTheBarrierHasWaited) {
  options.settings.on_agent_loss = OnAgentLoss::kPause;
  options.settings.agent_deadline_seconds = 3.0;
  MakeAndStart(2);
  ProposeAll(2);
  Propose(1);
  coordinator->OnAgentGone(2, now);
  Wait(100.0);
  Events();
  Join(12, {"r1"});
  Wait(2.0);
  EXPECT_THAT(Events(), ElementsAre("joined r1"));
  Wait(1.1);
  EXPECT_THAT(Events(), ElementsAre("left r1"));
}

TEST_F(LossTest, AnAgentIsNotRefusedWhileTheOneBeforeItMayBeDead) {
  MakeAndStart(2);
  Propose(1);
  endpoint.admissions.clear();
  Join(12, {"r1"});  // agent 2 has died, and its lease has not expired
  now += 0.1;
  Join(12, {"r1"});
  EXPECT_THAT(endpoint.admissions, IsEmpty());
  coordinator->OnAgentGone(2, now);
  Join(12, {"r1"});
  ASSERT_EQ(endpoint.admissions.size(), 1u);
  EXPECT_TRUE(endpoint.admissions[0].admitted);
}

TEST_F(LossTest, AnAgentIsRefusedOnceTheOneBeforeItShowsThatItLives) {
  MakeAndStart(2);
  endpoint.admissions.clear();
  Join(12, {"r1"});
  Propose(1);
  Propose(2);  // may have been sent before the join
  Join(12, {"r1"});
  EXPECT_THAT(endpoint.admissions, IsEmpty());
  Propose(1);
  Propose(2);  // answers a frame that was sent after the first join
  Join(12, {"r1"});
  ASSERT_EQ(endpoint.admissions.size(), 1u);
  EXPECT_FALSE(endpoint.admissions[0].admitted);
  EXPECT_THAT(endpoint.admissions[0].reason, HasSubstr("host2, pid 2"));
}

TEST_F(LossTest, AnAgentIsRefusedAfterTheLeaseOfTheOneBeforeIt) {
  options.lease_seconds = 2.0;
  Make(2);
  Join(1);
  endpoint.admissions.clear();
  Join(11, {"r0"});
  now += 4.1;
  Join(11, {"r0"});
  ASSERT_EQ(endpoint.admissions.size(), 1u);
  EXPECT_FALSE(endpoint.admissions[0].admitted);
}

TEST_F(LossTest, ALossAfterTheLastTickEndsTheRun) {
  options.settings.ticks = 1;
  MakeAndStart(2);
  Propose(1);
  coordinator->OnAgentGone(2, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(coordinator->phase(), Phase::kEnding);
  coordinator->OnAgentGone(1, now);
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
}

}  // namespace
}  // namespace troupe
