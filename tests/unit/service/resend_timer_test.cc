#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/service/coordinator_fixture.h"
#include "troupe/random.h"
#include "world-service/service/tick_inputs.h"

namespace troupe {
namespace {

using ::testing::Ge;
using ::testing::IsEmpty;

constexpr double kDeadline = 10.0;

// The times of the resends until the deadline, in s after the frame. `answers`: of other agents, at these times.
std::vector<double> Resends(ResendTimer& timer, const std::vector<double>& answers = {}) {
  std::vector<double> resends;
  auto answer = answers.begin();
  timer.Start(0.0);
  while (timer.due() < kDeadline || answer != answers.end()) {
    if (answer != answers.end() && *answer <= timer.due()) {
      timer.Answered(*answer++);
    } else {
      resends.push_back(timer.due());
      timer.Resent(timer.due());
    }
  }
  return resends;
}

TEST(ResendTimerTest, IsFarMoreFrequentThanTheDeadline) {
  ResendTimer timer(kDeadline);
  EXPECT_THAT(Resends(timer).size(), Ge(99u));
}

TEST(ResendTimerTest, AnswersOfOthersCannotPostponeAResendForLong) {
  std::vector<double> answers;
  for (int i = 1; i < 1000; ++i) answers.push_back(0.01 * i);
  ResendTimer timer(kDeadline);
  EXPECT_THAT(Resends(timer, answers).size(), Ge(9u));
}

TEST(ResendTimerTest, WithoutADeadlineItWaitsUpToASecond) {
  ResendTimer timer(0.0);
  const std::vector<double> resends = Resends(timer);
  EXPECT_NEAR(resends.back() - resends[resends.size() - 2], ResendTimer::kLongestWait, 1e-9);
}

// Over a slow link: each answer arrives `delay` after the first frame, and each resend is answered once more. Returns
// the number of resends in the tick.
int ResendsOfSlowTick(ResendTimer& timer, double delay, int agents) {
  int resends = 0;
  timer.Start(0.0);
  for (; timer.due() < delay; ++resends) timer.Resent(timer.due());
  for (int i = 0; i < agents; ++i) timer.Answered(delay);
  for (int i = 0; i < resends * agents; ++i) timer.AnsweredTwice();
  return resends;
}

TEST(ResendTimerTest, NeedlessResendsBecomeRare) {
  ResendTimer timer(kDeadline);
  EXPECT_THAT(ResendsOfSlowTick(timer, 0.8, 20), Ge(8));  // nothing is learned yet
  for (int tick = 0; tick < 10; ++tick) ResendsOfSlowTick(timer, 0.8, 20);
  for (int tick = 0; tick < 10; ++tick) EXPECT_LE(ResendsOfSlowTick(timer, 0.8, 20), 2) << tick;
  // On a link that is fast again they are soon as frequent as before.
  for (int tick = 0; tick < 60; ++tick) ResendsOfSlowTick(timer, 0.001, 20);
  EXPECT_THAT(Resends(timer).size(), Ge(99u));
}

// The probability that an agent is lost in a tick, because all round trips within the deadline fail.
double ProbabilityOfLoss(const ResendTimer& timer, double loss) {
  ResendTimer copy = timer;
  const double failure = 1.0 - (1.0 - loss) * (1.0 - loss);
  return std::pow(failure, 1.0 + static_cast<double>(Resends(copy).size()));
}

TEST(ResendTimerTest, LossOfMessagesLosesNoAgent) {
  // Of a million ticks with a hundred agents.
  EXPECT_LT(1e8 * ProbabilityOfLoss(ResendTimer(kDeadline), 0.3), 1e-12);
  EXPECT_LT(1e8 * ProbabilityOfLoss(ResendTimer(kDeadline), 0.45), 1e-6);
}

class LossyRunTest : public test::CoordinatorTest {
 protected:
  static constexpr AgentId kAgents = 8;

  bool Arrives(double loss) { return RandomUniform({1, draws_++}) >= loss; }
  // Delivers the frames that were sent since the last call, and the answers to them.
  void Exchange(double loss) {
    for (; delivered_ < endpoint.frames.size(); ++delivered_) {
      const FrameMessage frame = endpoint.frames[delivered_];
      for (AgentId agent = 1; agent <= kAgents; ++agent) {
        if (Arrives(loss) && Arrives(loss)) {
          coordinator->OnProposal(ProposalOf(agent, 0.1, frame.state.tick + 1), now);
        }
      }
    }
  }

  std::size_t delivered_ = 0;
  std::uint64_t draws_ = 0;
};

TEST_F(LossyRunTest, NoAgentIsLostByTheLossOfMessages) {
  constexpr double kLoss = 0.4;
  MakeAndStart(kAgents);
  while (tick() < 2000) {
    Exchange(kLoss);
    if (delivered_ == endpoint.frames.size()) Wait(coordinator->NextPoll() - now);
    ASSERT_THAT(Events(), IsEmpty()) << "tick " << tick();
  }
  EXPECT_EQ(coordinator->present_agents(), kAgents);
}

}  // namespace
}  // namespace troupe
