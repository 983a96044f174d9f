#include <gmock/gmock.h>

#include "tests/unit/service/live_run_fixture.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

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
