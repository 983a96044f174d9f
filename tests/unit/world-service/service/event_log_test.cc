#include "world-service/service/event_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "tests/unit/world-service/service/live_run_fixture.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(EventLog, OrdersEventsBetweenFramesByRobotBeforeThoseOfTheStep) {
  EventLog log;
  log.Add(EventType::kJoined, 4, RobotId(2), "b");
  log.Add(EventType::kJoined, 4, RobotId(0), "a");
  log.Add(EventType::kProposalRejected, 4, std::nullopt, "c");
  const Event stall{5, EventType::kStallBegan, RobotId(1), ModelId(3), ""};
  EXPECT_THAT(log.CompleteFrame(5, {stall}),
              ElementsAre(Event{5, EventType::kProposalRejected, std::nullopt, std::nullopt, "c"},
                          Event{5, EventType::kJoined, RobotId(0), std::nullopt, "a"},
                          Event{5, EventType::kJoined, RobotId(2), std::nullopt, "b"}, stall));
  EXPECT_THAT(log.CompleteFrame(6, {}), IsEmpty());
}

TEST(NoticeList, NoticesOfPeersAreShortPlainLines) {
  NoticeList notices;
  notices.AddFromPeer("robot r: \xff\x1b[2J\n");
  notices.AddFromPeer(std::string(999, 'x') + "\u00e4");
  EXPECT_EQ(notices.Drain(), (std::vector<std::string>{"robot r: ? [2J ", std::string(999, 'x')}));
}

TEST(EventLog, ReportsEachEventOnceInOrder) {
  EventLog log;
  log.Add(EventType::kLeft, 4, RobotId(2), "");
  log.CompleteFrame(5, {{5, EventType::kStallBegan, RobotId(1), std::nullopt, ""}});
  EXPECT_THAT(log.DrainUnreported(), SizeIs(2));
  EXPECT_THAT(log.DrainUnreported(), IsEmpty());
  EXPECT_EQ(log.stalls(), 1u);
}

TEST(ToldEvents, AreALineForAnAgentWithManyRobots) {
  const WorldDescription world = test::PlaneWorld(30);
  std::vector<Event> events;
  for (std::size_t i = 0; i < 12; ++i) events.push_back({4, EventType::kLeft, RobotId(i), {}, "h, pid 1: why"});
  events.push_back({4, EventType::kLeft, RobotId(12), {}, "h, pid 2: why"});
  events.push_back({4, EventType::kStallBegan, RobotId(13), {}, ""});
  std::vector<std::string> texts;
  for (const ToldEvent& told : ToldEvents(world, events)) texts.push_back(told.text);
  EXPECT_THAT(texts, ElementsAre("tick 4: r0, r1, r2, r3, r4, r5, r6, r7, r8, r9 and 2 more have lost their agent "
                                 "(h, pid 1: why)",
                                 "tick 4: r12 has lost its agent (h, pid 2: why)", "tick 4: r13 stalled"));
}

TEST(ToldEvents, CountTheRobotsOfFurtherAgents) {
  const WorldDescription world = test::PlaneWorld(30);
  std::vector<Event> events;
  for (std::size_t i = 0; i < 30; ++i) events.push_back({4, EventType::kLeft, RobotId(i), {}, std::to_string(i / 2)});
  const std::vector<ToldEvent> told = ToldEvents(world, events);
  ASSERT_THAT(told, SizeIs(11));
  EXPECT_EQ(told[0].text, "tick 4: r0, r1 have lost their agent (0)");
  EXPECT_EQ(told[10].text, "tick 4: 10 more robots have lost their agents");
}

TEST(EventText, NamesTheEventItsParticipantsAndItsTick) {
  const WorldDescription world = test::PlaneWorld(2);
  EXPECT_EQ(EventText(world, {7, EventType::kStallBegan, RobotId(0), ModelId(1), ""}), "tick 7: r0 stalled at r1");
  EXPECT_EQ(EventText(world, {7, EventType::kStallBegan, RobotId(0), std::nullopt, ""}), "tick 7: r0 stalled");
  EXPECT_EQ(EventText(world, {8, EventType::kStallEnded, RobotId(0), std::nullopt, ""}),
            "tick 8: r0 moves freely again");
  EXPECT_EQ(EventText(world, {9, EventType::kLeft, RobotId(1), std::nullopt, "why"}),
            "tick 9: r1 has lost its agent (why)");
  EXPECT_EQ(EventText(world, {9, EventType::kProposalRejected, std::nullopt, std::nullopt, "why"}),
            "tick 9: proposal rejected (why)");
  const ModelId box(1);  // any model with a name serves for these texts
  EXPECT_EQ(EventText(world, {9, EventType::kBlocked, RobotId(0), ModelId(1), "lift", {}}),
            "tick 9: r0 is blocked by r1 (lift)");
  EXPECT_EQ(EventText(world, {9, EventType::kBlocked, RobotId(0), {}, "lift", {}}),
            "tick 9: r0 is blocked by the ground (lift)");
  EXPECT_EQ(EventText(world, {9, EventType::kGripped, RobotId(0), {}, "hand", box}), "tick 9: r0 holds r1 (hand)");
  EXPECT_EQ(EventText(world, {9, EventType::kReleased, RobotId(0), {}, "hand", box}), "tick 9: r0 released r1 (hand)");
  EXPECT_EQ(EventText(world, {9, EventType::kLanded, {}, {}, "", box}), "tick 9: r1 landed on the ground");
  EXPECT_EQ(EventText(world, {9, EventType::kUnstable, {}, ModelId(0), "", box}),
            "tick 9: r1 landed out of balance on r0");
}

class RunStatisticsTest : public test::LiveRunTest {};

TEST_F(RunStatisticsTest, NameTheRobotsWithoutAgentsAndThoseThatAreLate) {
  Make();
  const WorldEditor editor(*run_, *engine_);
  RunStatistics statistics(*run_, *engine_, editor, now_);
  now_ += 2.0;
  EXPECT_THAT(statistics.MakeStatus(now_).waiting_for, ElementsAre("r0", "r1"));
  EXPECT_NEAR(statistics.MakeStatus(now_).waiting_seconds, 2.0, 1e-9);
  Join(1);
  Join(2);
  engine_->Begin(now_);
  Answer(2);
  EXPECT_THAT(statistics.MakeStatus(now_ + 0.1).waiting_for, IsEmpty());
  EXPECT_THAT(statistics.MakeStatus(now_ + 0.5).waiting_for, ElementsAre("r0"));
}

TEST_F(RunStatisticsTest, MeasureTheRealTimeFactorSinceTheStatusBefore) {
  MakeAndBegin();
  const WorldEditor editor(*run_, *engine_);
  RunStatistics statistics(*run_, *engine_, editor, now_);
  AnswerBoth();
  AnswerBoth();
  now_ += 0.1;
  EXPECT_NEAR(statistics.MakeStatus(now_).real_time_factor, 2.0, 1e-9);  // two ticks of 0.1 s
  now_ += 0.1;
  EXPECT_EQ(statistics.MakeStatus(now_).real_time_factor, 0.0);
  EXPECT_EQ(statistics.MakeSummary().ticks, 2u);
  EXPECT_NEAR(statistics.MakeSummary().sim_seconds, 0.2, 1e-12);
}

TEST_F(RunStatisticsTest, HaveThePhasesOfATick) {
  PhaseTimes times;
  options_.phase_times = &times;
  MakeAndBegin();
  const WorldEditor editor(*run_, *engine_);
  RunStatistics statistics(*run_, *engine_, editor, now_);
  EXPECT_EQ(statistics.MakeStatus(now_).phases, PhaseSeconds());
  for (int tick = 0; tick < 10; ++tick) AnswerBoth();
  const PhaseSeconds phases = statistics.MakeStatus(now_).phases;
  for (const double time : {phases.wait, phases.step, phases.record, phases.publish}) EXPECT_GT(time, 0.0);
}

TEST_F(RunStatisticsTest, ListTheSlowestRobotFirst) {
  MakeAndBegin();
  const WorldEditor editor(*run_, *engine_);
  const RunStatistics statistics(*run_, *engine_, editor, now_);
  for (const auto& [last, wait] : {std::pair<AgentId, double>{2, 0.5}, {1, 0.1}, {2, 0.2}}) {
    Answer(3 - last);
    now_ += wait;
    Answer(last);
  }
  const std::vector<SlowRobot> slowest = statistics.MakeSummary().slowest;
  ASSERT_EQ(slowest.size(), 2u);
  EXPECT_EQ(slowest[0].robot, "r1");
  EXPECT_EQ(slowest[0].times_last, 2u);
  EXPECT_NEAR(slowest[0].waited_seconds, 0.7, 1e-9);
  EXPECT_EQ(slowest[1].robot, "r0");
}

}  // namespace
}  // namespace troupe
