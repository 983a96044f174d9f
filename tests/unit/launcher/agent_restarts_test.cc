#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "command_line/parse_command_line.h"
#include "launcher/supervise/restarts.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kKilled = 128 + SIGKILL;

TEST(AgentRestartsTest, StartsADeadAgentAgainAfterADelay) {
  AgentRestarts restarts(3);
  EXPECT_EQ(restarts.NextDue(), std::nullopt);
  EXPECT_EQ(restarts.OnEnd(7, kKilled, 50.0), 50.1);
  EXPECT_EQ(restarts.NextDue(), 50.1);
  EXPECT_THAT(restarts.DrainDue(50.05), IsEmpty());
  EXPECT_THAT(restarts.DrainDue(50.1), ElementsAre(7));
  EXPECT_THAT(restarts.DrainDue(60.0), IsEmpty());
  EXPECT_EQ(restarts.NextDue(), std::nullopt);
}

TEST(AgentRestartsTest, StartsAnAgentAgainAsOftenAsTheLimitSays) {
  AgentRestarts restarts(2);
  EXPECT_TRUE(restarts.OnEnd(0, kKilled, 0.0));
  EXPECT_TRUE(restarts.OnEnd(0, kExitFailed, 1.0));
  EXPECT_EQ(restarts.CountOf(0), 2u);
  EXPECT_FALSE(restarts.OnEnd(0, kKilled, 100.0));
  EXPECT_TRUE(restarts.OnEnd(1, kKilled, 100.0)) << "another agent has restarts of its own";
  AgentRestarts none(0);
  EXPECT_FALSE(none.OnEnd(0, kKilled, 0.0));
}

TEST(AgentRestartsTest, WaitsLongerEachTimeUpToALimit) {
  AgentRestarts restarts(1'000'000);
  double last = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double delay = restarts.OnEnd(3, kKilled, 100.0).value() - 100.0;
    EXPECT_GE(delay, last);
    EXPECT_LE(delay, 10.0 + 1e-9);
    last = delay;
  }
  EXPECT_NEAR(last, 10.0, 1e-9);
}

TEST(AgentRestartsTest, DoesNotRepeatAnEndInOrderOrABadInput) {
  AgentRestarts restarts(3);
  for (const int status : {kExitDone, kExitBadInput, kExitOutputFailed, kExitInterrupted}) {
    EXPECT_FALSE(restarts.OnEnd(0, status, 0.0)) << status;
  }
  EXPECT_EQ(restarts.CountOf(0), 0u);
  for (const int status : {1, kExitFailed, 127, 128 + SIGSEGV, kKilled}) {
    EXPECT_TRUE(AgentRestarts(1).OnEnd(0, status, 0.0)) << status;
  }
}

TEST(AgentRestartsTest, ReturnsDueAgentsByNumber) {
  AgentRestarts restarts(3);
  for (const std::size_t agent : {5u, 2u, 9u}) restarts.OnEnd(agent, kKilled, 1.0);
  restarts.OnEnd(1, kKilled, 30.0);
  EXPECT_EQ(restarts.NextDue(), 1.1);
  EXPECT_THAT(restarts.DrainDue(2.0), ElementsAre(2, 5, 9));
  EXPECT_EQ(restarts.NextDue(), 30.1);
}

TEST(AgentRestartsTest, StartsAgentsThatDiedTogetherOneAfterAnother) {
  AgentRestarts restarts(3);
  for (std::size_t agent = 0; agent < 100; ++agent) restarts.OnEnd(agent, kKilled, 10.0);
  double now = 10.0;
  int started = 0;
  while (const std::optional<double> next = restarts.NextDue()) {
    EXPECT_TRUE(started == 0 || *next > now + 0.02) << started;
    now = *next;
    const std::vector<AgentRestarts::Agent> due = restarts.DrainDue(now);
    ASSERT_EQ(due.size(), 1u);
    ++started;
  }
  EXPECT_EQ(started, 100);
  EXPECT_LT(now, 13.0);
}

TEST(AgentRestartsTest, MakesNoRestartOnceTheRunEnds) {
  AgentRestarts restarts(3);
  restarts.OnEnd(0, kKilled, 0.0);
  restarts.Cancel();
  EXPECT_EQ(restarts.NextDue(), std::nullopt);
  EXPECT_THAT(restarts.DrainDue(100.0), IsEmpty());
}

}  // namespace
}  // namespace troupe
