// Messages of a hostile or broken peer: their only effects are an event, and a robot that stands still.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "world-service/service/tick_inputs.h"

namespace troupe {
namespace {

using test::CoordinatorTest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RejectionTest : public CoordinatorTest {
 protected:
  void SetUp() override { MakeAndStart(2); }
  std::string OnlyDetail() {
    const std::vector<Event> events = coordinator->DrainEvents();
    EXPECT_THAT(events, SizeIs(1));
    return events.empty() ? "" : events[0].detail;
  }
};

TEST_F(RejectionTest, NumbersThatAreNotFinite) {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Tick before = tick();
    const double place = Travel(1);
    Propose(2, bad);
    EXPECT_THAT(Events(), ElementsAre("proposal_rejected r1"));
    Propose(1);
    EXPECT_EQ(tick(), before + 1);  // the barrier continues,
    EXPECT_EQ(Travel(1), place);    // and the robot stands still
    EXPECT_EQ(endpoint.frames.back().events.at(0).type, EventType::kProposalRejected);
  }
}

TEST_F(RejectionTest, TwistsOverTheLimits) {
  Propose(1);
  Propose(2, 10.5);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(Travel(1), 0.0);
  EXPECT_THAT(OnlyDetail(), HasSubstr("expected"));
  Propose(1);
  Propose(2, 9.5);
  EXPECT_NEAR(Travel(1), 0.95, 1e-12);
}

TEST_F(RejectionTest, AnotherRun) {
  ProposalMessage proposal = ProposalOf(1, 1.0);
  proposal.run = kRun + 1;
  coordinator->OnProposal(proposal, now);
  EXPECT_THAT(OnlyDetail(), HasSubstr("another run"));
  Propose(2);
  EXPECT_EQ(tick(), 0u);  // it does not count as an answer
}

TEST_F(RejectionTest, AnAgentThatNeverJoined) {
  coordinator->OnProposal({kRun, 99, 1, {{RobotId(0), {}}}, {}}, now);
  EXPECT_THAT(OnlyDetail(), HasSubstr("not joined"));
  Propose(2);
  EXPECT_EQ(tick(), 0u);
}

TEST_F(RejectionTest, AFutureTick) {
  coordinator->OnProposal(ProposalOf(1, 1.0, 17), now);
  EXPECT_THAT(OnlyDetail(), HasSubstr("tick 17, expected 1"));
  Propose(2);
  EXPECT_EQ(tick(), 0u);
}

TEST_F(RejectionTest, RobotsOfOtherAgents) {
  Propose(1, 1.0);
  coordinator->OnProposal({kRun, 2, 1, {{RobotId(0), {5.0, 0, 0}}, {RobotId(1), {2.0, 0, 0}}}, {}}, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_NEAR(Travel(0), 0.1, 1e-12);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected r0"));
}

TEST_F(RejectionTest, RobotsThatDoNotExist) {
  Propose(1);
  coordinator->OnProposal({kRun, 2, 1, {{RobotId(1), {2.0, 0, 0}}, {RobotId(4000000000), {1.0, 0, 0}}}, {}}, now);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected"));
}

TEST_F(RejectionTest, ARobotNamedTwice) {
  Propose(1);
  coordinator->OnProposal({kRun, 2, 1, {{RobotId(1), {2.0, 0, 0}}, {RobotId(1), {3.0, 0, 0}}}, {}}, now);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected r1"));
}

TEST_F(RejectionTest, ARobotLeftOut) {
  Propose(1);
  coordinator->OnProposal({kRun, 2, 1, {}, {}}, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(Travel(1), 0.0);
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected r1"));
}

TEST_F(RejectionTest, AllOfAHostilePeerAreCountedAndFewReported) {
  for (int i = 0; i < 1000; ++i) coordinator->OnProposal({kRun, 99, 1, {}, {}}, now);
  EXPECT_THAT(coordinator->DrainEvents(), SizeIs(10));
  now += 1.1;
  coordinator->OnProposal({kRun, 99, 1, {}, {}}, now);
  const std::vector<Event> events = coordinator->DrainEvents();
  ASSERT_THAT(events, SizeIs(2));
  EXPECT_THAT(events[0].detail, HasSubstr("990 more"));
  EXPECT_EQ(coordinator->MakeSummary().rejected, 1001u);
  Propose(1);
  Propose(2);
  EXPECT_EQ(tick(), 1u);
  EXPECT_LE(endpoint.frames.back().events.size(), 12u);
}

TEST_F(RejectionTest, ReportsWithoutEndDoNotGrowTheService) {
  ProposalMessage proposal = ProposalOf(1, 0.0);
  proposal.reports.assign(100000, "again");
  coordinator->DrainEvents();
  coordinator->OnProposal(proposal, now);
  Propose(2);
  EXPECT_EQ(coordinator->DrainEvents().size(), 100u);
  EXPECT_EQ(endpoint.frames.back().events.size(), 100u);
  // The next tick has room again.
  Propose(1);
  proposal = ProposalOf(2, 0.0);
  proposal.reports = {"robot r1: once"};
  coordinator->OnProposal(proposal, now);
  EXPECT_EQ(endpoint.frames.back().events.size(), 1u);
}

TEST_F(RejectionTest, ProposalsBeforeTheStartAreIgnored) {
  Make(2);
  coordinator->OnProposal({kRun, 1, 1, {}, {}}, now);
  EXPECT_THAT(Events(), IsEmpty());
}

using ::testing::AllOf;

class RealtimeTest : public CoordinatorTest {
 protected:
  RealtimeTest() { options.settings.mode = Mode::kRealtime; }
  // Waits until just after the next tick is due.
  void NextTick() { Wait(0.1001); }
};

TEST_F(RealtimeTest, NoticesThatItIsNotDeterministic) {
  Make(1);
  EXPECT_THAT(coordinator->DrainNotices(), ElementsAre(HasSubstr("not the same"), HasSubstr("1 x real time")));
}

TEST_F(RealtimeTest, TicksAreNotEarlyEvenWhenAllAgentsHaveAnswered) {
  MakeAndStart(1);
  Propose(1);
  EXPECT_EQ(tick(), 0u);
  EXPECT_NEAR(coordinator->NextPoll() - now, 0.1, 1e-9);
  NextTick();
  EXPECT_EQ(tick(), 1u);
  EXPECT_NEAR(Travel(0), 0.1, 1e-12);
}

TEST_F(RealtimeTest, ALateRobotKeepsItsCommandForOneTickAndThenStops) {
  MakeAndStart(2);
  Propose(1, 1.0);
  Propose(2, 2.0);
  NextTick();
  Propose(1, 1.0);
  NextTick();
  EXPECT_EQ(tick(), 2u);
  EXPECT_NEAR(Travel(1), 0.4, 1e-12);  // kept
  Propose(1, 1.0);
  NextTick();
  EXPECT_EQ(tick(), 3u);
  EXPECT_NEAR(Travel(1), 0.4, 1e-12);  // stopped
  EXPECT_NEAR(Travel(0), 0.3, 1e-12);
}

TEST_F(RealtimeTest, ARobotWithoutAnyProposalStandsStill) {
  MakeAndStart(1);
  NextTick();
  EXPECT_EQ(tick(), 1u);
  EXPECT_EQ(Travel(0), 0.0);
}

TEST_F(RealtimeTest, ACommandThatArrivesOneTickLateIsTheNextTicksCommand) {
  MakeAndStart(1);
  NextTick();
  coordinator->OnProposal(ProposalOf(1, 3.0, 1), now);
  EXPECT_THAT(Events(), IsEmpty());
  NextTick();
  EXPECT_NEAR(Travel(0), 0.3, 1e-12);
  NextTick();
  EXPECT_NEAR(Travel(0), 0.3, 1e-12);
}

TEST_F(RealtimeTest, ALateCommandDoesNotReplaceANewerOne) {
  MakeAndStart(1);
  Propose(1, 1.0);
  NextTick();
  coordinator->OnProposal(ProposalOf(1, 3.0, 1), now);  // a late duplicate with another command
  NextTick();
  EXPECT_NEAR(Travel(0), 0.2, 1e-12);
}

TEST_F(RealtimeTest, ACommandThatIsKeptMustStillBeWithinTheLimits) {
  Make(1);
  WorldDescription world = scene->world();
  world.robots[0].drive.acceleration.x = {-100.0, 20.0};  // 2 m/s in a tick
  scene = std::make_unique<Scene>(world);
  coordinator.emplace(scene, options, endpoint, observers, now);
  Join(1);
  Events();
  Propose(1, 2.0);
  NextTick();
  Propose(1, 4.0);
  NextTick();
  EXPECT_NEAR(Travel(0), 0.6, 1e-12);
  coordinator->OnProposal(ProposalOf(1, 4.0, 1), now);  // old: no effect
  NextTick();
  EXPECT_NEAR(Travel(0), 1.0, 1e-12);  // keeps 4 m/s
  NextTick();
  EXPECT_NEAR(Travel(0), 1.0, 1e-12);
  coordinator->OnProposal(ProposalOf(1, 4.0, tick()), now);  // late, and beyond the acceleration of a robot at rest
  EXPECT_THAT(Events(), ElementsAre("proposal_rejected r0"));
  NextTick();
  EXPECT_NEAR(Travel(0), 1.0, 1e-12);
}

TEST_F(RealtimeTest, SpeedPacesIt) {
  options.settings.speed = 10.0;
  MakeAndStart(1);
  Wait(0.0101);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(RealtimeTest, APaceThatTheAgentsCannotKeepIsTold) {
  options.settings.speed = 10.0;
  MakeAndStart(2);
  coordinator->DrainNotices();
  for (int i = 0; i < 400; ++i) {
    Propose(1);
    if (i % 4 != 0) Propose(2);
    Wait(0.0101);
  }
  EXPECT_THAT(coordinator->DrainNotices(), IsEmpty());
  for (int i = 0; i < 400; ++i) {
    Propose(1);
    Wait(0.0101);
  }
  EXPECT_THAT(coordinator->DrainNotices(), ElementsAre(AllOf(HasSubstr("percent"), HasSubstr("pace of 10 x"))));
}

TEST(PaceWatchTest, CountsTheShareOfLateProposals) {
  PaceWatch watch;
  for (double now = 0.0; now < 10.0; now += 0.1) EXPECT_FALSE(watch.Committed(10, 2, now));
  std::optional<int> told;
  for (double now = 10.0; now < 20.0; now += 0.1) {
    const std::optional<int> late = watch.Committed(10, 5, now);
    if (late) {
      EXPECT_FALSE(told) << "once in a while";
      told = late;
    }
  }
  EXPECT_EQ(told.value_or(0), 50);
}

TEST_F(RealtimeTest, ASilentAgentIsLostAtTheDeadline) {
  options.settings.agent_deadline_seconds = 1.0;
  MakeAndStart(2);
  for (int i = 0; i < 9; ++i) {
    Propose(1, 0.0);
    NextTick();
  }
  EXPECT_THAT(Events(), IsEmpty());
  for (int i = 0; i < 2; ++i) {
    Propose(1, 0.0);
    NextTick();
  }
  EXPECT_THAT(Events(), ElementsAre("left r1"));
}

TEST_F(RealtimeTest, PauseStopsItToo) {
  options.settings.on_agent_loss = OnAgentLoss::kPause;
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  NextTick();
  EXPECT_EQ(tick(), 0u);
}

}  // namespace
}  // namespace troupe
