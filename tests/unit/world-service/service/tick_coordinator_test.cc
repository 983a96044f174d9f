#include "world-service/service/tick_coordinator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/model/states.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"

namespace troupe {
namespace {

using test::CoordinatorTest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Phase = TickCoordinator::Phase;

class TickCoordinatorTest : public CoordinatorTest {};

TEST_F(TickCoordinatorTest, SendsNoFrameBeforeAllRobotsHaveAgents) {
  Make(2);
  Join(1);
  Wait(1.0);
  EXPECT_THAT(endpoint.frames, IsEmpty());
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  EXPECT_THAT(coordinator->MakeStatus(now).waiting_for, ElementsAre("r1"));
  Join(2);
  ASSERT_EQ(frames(), 1u);
  EXPECT_EQ(tick(), 0u);
  EXPECT_EQ(endpoint.frames[0].run, kRun);
  EXPECT_EQ(endpoint.frames[0].state, PlacedState(scene->world()));
  EXPECT_EQ(coordinator->startup_seconds(), 1.0);
  EXPECT_THAT(Events(), ElementsAre("joined r0", "joined r1"));
  EXPECT_EQ(endpoint.frames[0].events.size(), 2u);
}

TEST_F(TickCoordinatorTest, StepsAtOnceWhenTheLastProposalArrives) {
  MakeAndStart(2);
  Propose(2);
  EXPECT_EQ(tick(), 0u);
  Propose(1);
  EXPECT_EQ(tick(), 1u);
  EXPECT_NEAR(Travel(0), 0.1, 1e-12);
  EXPECT_EQ(endpoint.frames.back().state_hash, StateHash(endpoint.frames.back().state));
  EXPECT_FALSE(endpoint.frames.back().last);
}

TEST_F(TickCoordinatorTest, OneAgentMayHaveManyRobots) {
  Make(3);
  Join(7, {"r2", "r0", "r1"});
  coordinator->OnProposal({kRun, 7, 1, {{RobotId(0), {}}, {RobotId(1), {2.0, 0, 0}}, {RobotId(2), {}}}, {}}, now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_NEAR(Travel(1), 0.2, 1e-12);
}

TEST_F(TickCoordinatorTest, IgnoresDuplicateAndOldProposals) {
  MakeAndStart(2);
  Propose(1, 1.0);
  Propose(1, 5.0);  // the first one counts
  Propose(2);
  EXPECT_NEAR(Travel(0), 0.1, 1e-12);
  coordinator->OnProposal(ProposalOf(1, 5.0, 1), now);
  EXPECT_EQ(tick(), 1u);
  EXPECT_THAT(Events(), IsEmpty());
  EXPECT_EQ(coordinator->MakeSummary().rejected, 0u);
}

TEST_F(TickCoordinatorTest, AdmitsAllAgentsTogetherWhenTheRunBegins) {
  Make(2);
  Join(1);
  Join(1);
  EXPECT_THAT(endpoint.admissions, IsEmpty());
  Join(2);
  ASSERT_EQ(endpoint.admissions.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(endpoint.admissions[i].admitted);
    EXPECT_EQ(endpoint.admissions[i].agent, i + 1);
  }
}

TEST_F(TickCoordinatorTest, AnswersARepeatedJoinAgain) {
  MakeAndStart(2);
  endpoint.admissions.clear();
  Join(1);
  ASSERT_EQ(endpoint.admissions.size(), 1u);
  EXPECT_TRUE(endpoint.admissions[0].admitted);
  EXPECT_EQ(endpoint.admissions[0].agent, 1u);
}

TEST_F(TickCoordinatorTest, RefusesABadJoinWithAReason) {
  Make(1);
  Join(1, {"r0", "nobody"});
  ASSERT_EQ(endpoint.admissions.size(), 1u);
  EXPECT_FALSE(endpoint.admissions[0].admitted);
  EXPECT_THAT(endpoint.admissions[0].reason, HasSubstr("no robot \"nobody\""));
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
}

TEST_F(TickCoordinatorTest, DoesNotAnswerAJoinOfAnotherRun) {
  Make(1);
  JoinMessage join = JoinOf(1, {"r0"});
  join.run = kRun + 1;
  coordinator->OnJoin(join, now);
  EXPECT_THAT(endpoint.admissions, IsEmpty());
}

TEST_F(TickCoordinatorTest, ResendsAFrameThatAnAgentLeavesUnanswered) {
  MakeAndStart(2);
  Propose(1);
  EXPECT_NEAR(coordinator->NextPoll() - now, 0.05, 1e-9);
  Wait(0.04);
  EXPECT_EQ(frames(), 1u);
  Wait(0.02);
  ASSERT_EQ(frames(), 2u);
  EXPECT_EQ(endpoint.frames[1].state, endpoint.frames[0].state);
  EXPECT_EQ(endpoint.frames[1].events, endpoint.frames[0].events);
  EXPECT_EQ(coordinator->MakeSummary().frames_repeated, 1u);
}

TEST_F(TickCoordinatorTest, ResendsAFrameLessAndLessOftenWithoutADeadline) {
  options.settings.agent_deadline_seconds = 0.0;
  MakeAndStart(1);
  const double began = now;
  std::vector<double> repeats;
  while (repeats.size() < 7) {
    const std::size_t before = frames();
    Wait(coordinator->NextPoll() - now);
    if (frames() > before) repeats.push_back(now - began);
  }
  using ::testing::DoubleNear;
  EXPECT_THAT(repeats, ElementsAre(DoubleNear(0.05, 1e-9), DoubleNear(0.15, 1e-9), DoubleNear(0.35, 1e-9),
                                   DoubleNear(0.75, 1e-9), DoubleNear(1.55, 1e-9), DoubleNear(2.55, 1e-9),
                                   DoubleNear(3.55, 1e-9)));
}

TEST_F(TickCoordinatorTest, AResentFrameNamesTheMissingAgentsUnlessTheyAreMost) {
  MakeAndStart(4);
  Propose(2);
  Wait(0.06);
  ASSERT_EQ(frames(), 2u);
  EXPECT_THAT(endpoint.frames[1].awaited, IsEmpty());
  Propose(4);
  Wait(0.12);
  ASSERT_EQ(frames(), 3u);
  EXPECT_THAT(endpoint.frames[2].awaited, ElementsAre(1u, 3u));
  Propose(1);
  Propose(3);
  ASSERT_EQ(frames(), 4u);
  EXPECT_THAT(endpoint.frames[3].awaited, IsEmpty());
}

TEST_F(TickCoordinatorTest, ResendsSoonerOnceAnswersHaveBeenFast) {
  MakeAndStart(2);
  for (int tick = 0; tick < 100; ++tick) {
    now += 0.001;
    Propose(1);
    now += 0.002;
    Propose(2);
  }
  const double wait = coordinator->NextPoll() - now;
  EXPECT_GT(wait, 0.002);
  EXPECT_LT(wait, 0.01);
  Propose(1);
  Wait(wait + 1e-6);  // the frame is resent; it had arrived, so agent 1 answers again
  Propose(1);
  now += 0.002;
  Propose(2);
  EXPECT_GT(coordinator->NextPoll() - now, wait);
}

TEST_F(TickCoordinatorTest, DoesNotResendAFrameWhileAnswersArrive) {
  MakeAndStart(10);
  for (AgentId agent = 1; agent <= 9; ++agent) {
    Wait(0.04);
    Propose(agent);
  }
  EXPECT_EQ(frames(), 1u);
}

TEST_F(TickCoordinatorTest, NamesTheRobotsThatItWaitsFor) {
  MakeAndStart(3);
  Propose(2);
  EXPECT_THAT(coordinator->MakeStatus(now).waiting_for, IsEmpty());  // no robot is late yet
  Wait(0.7);
  const StatusMessage status = coordinator->MakeStatus(now);
  EXPECT_THAT(status.waiting_for, ElementsAre("r0", "r2"));
  EXPECT_NEAR(status.waiting_seconds, 0.7, 1e-9);
}

TEST_F(TickCoordinatorTest, SummaryNamesTheSlowestRobots) {
  MakeAndStart(2);
  for (int i = 0; i < 3; ++i) {
    Propose(1);
    now += 0.03;
    Propose(2);
  }
  Propose(2);
  now += 0.01;
  Propose(1);
  const RunSummary summary = coordinator->MakeSummary();
  ASSERT_EQ(summary.slowest.size(), 2u);
  EXPECT_EQ(summary.slowest[0].robot, "r1");
  EXPECT_EQ(summary.slowest[0].times_last, 3u);
  EXPECT_NEAR(summary.slowest[0].waited_seconds, 0.09, 1e-9);
  EXPECT_EQ(summary.slowest[1].times_last, 1u);
  EXPECT_EQ(summary.ticks, 4u);
  EXPECT_NEAR(summary.sim_seconds, 0.4, 1e-12);
  EXPECT_NEAR(summary.wall_seconds, 0.1, 1e-9);
  EXPECT_NEAR(summary.real_time_factor, 4.0, 1e-6);
}

TEST_F(TickCoordinatorTest, MarksTheLastFrameAndResendsItUntilTheAgentsHaveLeft) {
  options.settings.ticks = 1;
  MakeAndStart(2);
  Propose(1);
  Propose(2);
  EXPECT_TRUE(endpoint.frames.back().last);
  EXPECT_EQ(coordinator->phase(), Phase::kEnding);
  const std::size_t before = frames();
  Wait(coordinator->NextPoll() - now);
  EXPECT_EQ(frames(), before + 1);
  EXPECT_TRUE(endpoint.frames.back().last);
  coordinator->OnAgentGone(1, now);
  EXPECT_EQ(coordinator->phase(), Phase::kEnding);
  coordinator->OnAgentGone(2, now);
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
  EXPECT_TRUE(coordinator->error().ok());
  EXPECT_THAT(coordinator->MakeSummary().lost, IsEmpty());
  EXPECT_THAT(Events(), IsEmpty());
}

TEST_F(TickCoordinatorTest, IsOverSoonEvenIfAnAgentDoesNotLeave) {
  options.settings.ticks = 0;
  Make(1);
  Join(1);
  EXPECT_TRUE(endpoint.frames.back().last);
  const double began = now;
  while (coordinator->phase() != Phase::kOver && now < began + 100.0) Wait(coordinator->NextPoll() - now);
  EXPECT_LE(now - began, 6.0);
}

// A refusal would end it, and with it the run, with an error.
TEST_F(TickCoordinatorTest, AnAgentThatIsStartedAgainAtTheEndReceivesTheLastFrame) {
  options.settings.ticks = 0;
  Make(1);
  Join(1);
  const std::size_t before = frames();
  const std::size_t answers = endpoint.admissions.size();
  Join(9, {"r0"});
  EXPECT_EQ(endpoint.admissions.size(), answers);
  ASSERT_EQ(frames(), before + 1);
  EXPECT_TRUE(endpoint.frames.back().last);
}

TEST_F(TickCoordinatorTest, StopsInOrder) {
  MakeAndStart(1);
  Propose(1);
  coordinator->Stop(now);
  EXPECT_TRUE(endpoint.frames.back().last);
  EXPECT_EQ(endpoint.frames.back().state, endpoint.frames[1].state);
  coordinator->OnAgentGone(1, now);
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
  EXPECT_TRUE(coordinator->MakeSummary().interrupted);
  EXPECT_EQ(coordinator->MakeSummary().ticks, 1u);
}

TEST_F(TickCoordinatorTest, AStopWhileItWaitsForAgentsEndsThoseThatHaveJoined) {
  Make(2);
  Join(1);
  coordinator->Stop(now);
  ASSERT_EQ(frames(), 1u);
  EXPECT_TRUE(endpoint.frames[0].last);
  coordinator->OnAgentGone(1, now);
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
  EXPECT_EQ(coordinator->MakeSummary().wall_seconds, 0.0);
}

TEST_F(TickCoordinatorTest, FailsWhenRobotsStayWithoutAgentsAndNamesThem) {
  options.start_timeout_seconds = 5.0;
  Make(3);
  Join(2);
  Wait(4.9);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  Wait(0.2);
  ASSERT_FALSE(coordinator->error().ok());
  EXPECT_THAT(coordinator->error().error().message, HasSubstr("r0, r2"));
  EXPECT_THAT(coordinator->error().error().message, HasSubstr("5 s"));
  EXPECT_TRUE(endpoint.frames.back().last);
}

TEST_F(TickCoordinatorTest, WaitsForEverWithoutAStartTimeout) {
  options.start_timeout_seconds = 0.0;
  Make(1);
  Wait(1e6);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
}

TEST_F(TickCoordinatorTest, AnAgentThatLeavesBeforeTheStartIsWaitedForAgain) {
  options.settings.on_agent_loss = OnAgentLoss::kAbort;
  Make(2);
  Join(1);
  coordinator->OnAgentGone(1, now);
  Join(2);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  Join(11, {"r0"});
  EXPECT_EQ(coordinator->phase(), Phase::kRunning);
}

TEST_F(TickCoordinatorTest, AWorldWithoutRobotsTicksByItself) {
  options.settings.ticks = 3;
  Make(0);
  for (int i = 0; i < 10 && coordinator->phase() != Phase::kOver; ++i) {
    EXPECT_LE(coordinator->NextPoll(), now);
    Wait(0.0);
  }
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
  EXPECT_EQ(tick(), 3u);
}

TEST_F(TickCoordinatorTest, SpeedPacesTicks) {
  options.settings.speed = 2.0;  // 0.05 s a tick
  MakeAndStart(1);
  Propose(1);
  EXPECT_EQ(tick(), 0u);
  EXPECT_NEAR(coordinator->NextPoll() - now, 0.05, 1e-9);
  Wait(0.04);
  EXPECT_EQ(tick(), 0u);
  Wait(0.011);
  EXPECT_EQ(tick(), 1u);
  // The delay by a late answer is caught up.
  Wait(0.109);
  Propose(1);
  EXPECT_EQ(tick(), 2u);
  Propose(1);
  EXPECT_EQ(tick(), 3u);
  Propose(1);
  EXPECT_EQ(tick(), 3u);
}

TEST_F(TickCoordinatorTest, ALongStopIsNotCaughtUp) {
  options.settings.speed = 1.0;
  MakeAndStart(1);
  now += 60.0;
  Propose(1);
  EXPECT_EQ(tick(), 1u);
  Propose(1);
  EXPECT_EQ(tick(), 1u);
  EXPECT_NEAR(coordinator->NextPoll() - now, 0.1, 1e-9);
}

TEST_F(TickCoordinatorTest, TheServiceWithTheHigherIdFails) {
  Make(1);
  SessionMessage rival{.run = kRun - 1, .host = "elsewhere", .pid = 4711};
  coordinator->OnRivalService(rival, now);
  ASSERT_FALSE(coordinator->error().ok());
  EXPECT_THAT(coordinator->error().error().message, HasSubstr("elsewhere, pid 4711"));
}

TEST_F(TickCoordinatorTest, TheServiceWithTheLowerIdContinues) {
  Make(1);
  SessionMessage rival;
  rival.run = kRun + 1;
  coordinator->OnRivalService(rival, now);
  coordinator->OnRivalService(rival, now);
  rival.run = kRun;  // its own session, received back
  coordinator->OnRivalService(rival, now);
  EXPECT_TRUE(coordinator->error().ok());
  EXPECT_EQ(coordinator->DrainNotices().size(), 1u);
}

TEST_F(TickCoordinatorTest, AServiceFailsWhenAnotherOneTicksAlready) {
  Make(1);
  SessionMessage rival;
  rival.run = kRun + 1;
  coordinator->OnRivalService(rival, now);
  EXPECT_TRUE(coordinator->error().ok());
  rival.begun = true;
  coordinator->OnRivalService(rival, now);
  EXPECT_FALSE(coordinator->error().ok());
}

TEST_F(TickCoordinatorTest, ARunningServiceIsNotStoppedByARival) {
  MakeAndStart(1);
  SessionMessage rival;
  rival.run = kRun - 1;
  coordinator->OnRivalService(rival, now);
  EXPECT_EQ(coordinator->phase(), Phase::kRunning);
}

TEST_F(TickCoordinatorTest, ReportsOfAgentsAreEventsOfTheirRobots) {
  MakeAndStart(2);
  coordinator->DrainEvents();
  ProposalMessage proposal = ProposalOf(2, 0.0);
  proposal.reports = {"robot r1: 3 units delivered", "robot r0: not its own", "no robot"};
  coordinator->OnProposal(proposal, now);
  Propose(1, 0.0);
  const FrameMessage& frame = endpoint.frames.back();
  const auto report = [&](std::optional<RobotId> robot, const std::string& text) -> Event {
    return {.tick = 1, .type = EventType::kReported, .robot = robot, .detail = text};
  };
  // Those without a robot are first.
  EXPECT_THAT(frame.events, ElementsAre(report({}, "host2, pid 2: robot r0: not its own"),
                                        report({}, "host2, pid 2: no robot"), report(RobotId(1), "3 units delivered")));
  const std::vector<Event> told = coordinator->DrainEvents();
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(EventText(scene->world(), told[0]), "tick 0: robot r1: 3 units delivered");
  EXPECT_THAT(coordinator->DrainEvents(), IsEmpty());
  Propose(1, 0.0);
  Propose(2, 0.0);
  EXPECT_THAT(endpoint.frames.back().events, IsEmpty());
}

}  // namespace
}  // namespace troupe
