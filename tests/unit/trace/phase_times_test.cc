#include <gtest/gtest.h>

#include "common/trace/tick_trace.h"

namespace troupe {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // ns

class PhaseTimesTest : public testing::Test {
 protected:
  // A tick with the phases as TickEngine has them, of these times in ms.
  void Tick(int wait, int step, int record, int publish) {
    Spend(TickPhase::kWait, wait);
    Spend(TickPhase::kStep, step);
    Spend(TickPhase::kRecord, record / 2);
    Spend(TickPhase::kPublish, publish);
    Spend(TickPhase::kRecord, record - record / 2);
    times_.Enter(TickPhase::kWait, now_);
  }
  void Spend(TickPhase phase, int milliseconds) {
    times_.Enter(phase, now_);
    now_ += milliseconds * kMillisecond;
  }
  double Mean(TickPhase phase) const { return times_.Mean(phase, now_); }

  PhaseTimes times_;
  std::int64_t now_ = 1'700'000'000'000'000'000;
};

TEST_F(PhaseTimesTest, AreZeroWithoutTicks) {
  EXPECT_EQ(Mean(TickPhase::kStep), 0.0);
  Spend(TickPhase::kWait, 300);
  EXPECT_EQ(Mean(TickPhase::kWait), 0.0);
}

TEST_F(PhaseTimesTest, AreMeansOfATickWithAllPartsOfAPhase) {
  for (int i = 0; i < 4; ++i) Tick(40, i % 2 == 0 ? 5 : 7, 6, 2);
  EXPECT_NEAR(Mean(TickPhase::kWait), 0.040, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kStep), 0.006, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kRecord), 0.006, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kPublish), 0.002, 1e-9);
}

TEST_F(PhaseTimesTest, ForgetWhatIsLongerAgoThanASecond) {
  for (int i = 0; i < 30; ++i) Tick(90, 10, 0, 0);
  for (int i = 0; i < 4; ++i) Tick(98, 2, 0, 0);
  EXPECT_GT(Mean(TickPhase::kStep), 0.002);
  for (int i = 0; i < 9; ++i) Tick(98, 2, 0, 0);
  EXPECT_NEAR(Mean(TickPhase::kStep), 0.002, 1e-9);
}

TEST_F(PhaseTimesTest, OfSlowTicksAreThoseOfTheLastOnes) {
  Tick(3000, 10, 2, 2);
  Tick(2000, 20, 2, 2);
  Tick(2000, 40, 2, 2);
  EXPECT_NEAR(Mean(TickPhase::kWait), 2.0, 1e-9);
  EXPECT_NEAR(Mean(TickPhase::kStep), 0.040, 1e-9);
}

TEST_F(PhaseTimesTest, DoNotCountAPause) {
  Tick(50, 4, 2, 2);
  now_ += 60'000 * kMillisecond;
  EXPECT_EQ(Mean(TickPhase::kStep), 0.0) << "nothing happens";
  times_.Restart(now_);
  for (int i = 0; i < 2; ++i) Tick(50, 4, 2, 2);
  EXPECT_NEAR(Mean(TickPhase::kWait), 0.050, 1e-9);
}

}  // namespace
}  // namespace troupe
