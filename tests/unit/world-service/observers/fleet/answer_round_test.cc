#include "world-service/observers/fleet/answer_round.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

using Act = AnswerRound::Act;

TEST(AnswerRoundTest, ALockstepAsksWhenTheBrokerHasAllMessagesAndGoesOnWhenItHasAllAnswers) {
  AnswerRound round({.is_lockstep = true});
  EXPECT_TRUE(round.is_over());
  EXPECT_EQ(round.Next(0.0), Act::kNone);
  round.Begin();
  EXPECT_FALSE(round.is_over());
  ASSERT_EQ(round.Next(1.0), Act::kEcho);
  const std::uint64_t first = round.token();
  round.Echoed({3, 4}, 1.0);
  EXPECT_EQ(round.Next(1.0), Act::kNone);
  round.Answered();  // to an earlier question
  round.Returned(3, first);
  round.Returned(4, first - 1);  // of an earlier round
  EXPECT_EQ(round.Next(2.0), Act::kNone);
  round.Returned(4, first);
  ASSERT_EQ(round.Next(2.0), Act::kAsk);
  EXPECT_EQ(round.Next(2.5), Act::kNone);
  EXPECT_DOUBLE_EQ(round.Rest(2.5), AnswerRound::kAskAgain - 0.5);
  EXPECT_EQ(round.Next(2.0 + AnswerRound::kAskAgain), Act::kAsk);  // no fleet control may have been there
  round.Answered();
  ASSERT_EQ(round.Next(4.0), Act::kEcho);
  EXPECT_NE(round.token(), first);
  round.Echoed({3, 4}, 4.0);
  round.Returned(3, round.token());
  round.Lost(4);
  ASSERT_EQ(round.Next(4.0), Act::kContinue);
  EXPECT_TRUE(round.is_over());
  EXPECT_EQ(round.Next(5.0), Act::kNone);
  EXPECT_EQ(round.TakeMissing(), 0U);
}

TEST(AnswerRoundTest, ALockstepTellsOnceThatNoAnswerHasCome) {
  AnswerRound round({.is_lockstep = true});
  round.Begin();
  ASSERT_EQ(round.Next(0.0), Act::kEcho);
  round.Echoed({}, 0.0);
  ASSERT_EQ(round.Next(0.0), Act::kAsk);
  EXPECT_FALSE(round.TakeIsLate(AnswerRound::kLongAnswer - 0.1));
  EXPECT_TRUE(round.TakeIsLate(AnswerRound::kLongAnswer));
  EXPECT_FALSE(round.TakeIsLate(AnswerRound::kLongAnswer + 1.0));
}

TEST(AnswerRoundTest, AFleetControlThatLeavesEndsTheLockstep) {
  AnswerRound round({.is_lockstep = true});
  round.Begin();
  ASSERT_EQ(round.Next(0.0), Act::kEcho);
  round.Echoed({}, 0.0);
  ASSERT_EQ(round.Next(0.0), Act::kAsk);
  round.End();
  ASSERT_EQ(round.Next(0.0), Act::kEcho);
  round.Echoed({}, 0.0);
  ASSERT_EQ(round.Next(0.0), Act::kContinue);
  round.Begin();
  EXPECT_TRUE(round.is_over());
}

TEST(AnswerRoundTest, AQuietTimeBeginsWhenTheBrokerHasAllMessages) {
  AnswerRound round({.quiet_seconds = 0.3});
  round.Begin();
  ASSERT_EQ(round.Next(0.0), Act::kEcho);
  round.Echoed({0}, 0.0);
  EXPECT_EQ(round.Next(5.0), Act::kNone);  // a slow broker
  round.Returned(0, round.token());
  EXPECT_EQ(round.Next(6.0), Act::kNone);
  round.Heard(6.2);
  EXPECT_EQ(round.Next(6.4), Act::kNone);
  ASSERT_EQ(round.Next(6.5), Act::kEcho);
  round.Echoed({0}, 6.5);
  round.Returned(0, round.token());
  EXPECT_EQ(round.Next(6.5), Act::kContinue);
}

TEST(AnswerRoundTest, AQuietTimeEndsAlthoughMessagesKeepComing) {
  AnswerRound round({.quiet_seconds = 0.1});
  round.Begin();
  ASSERT_EQ(round.Next(0.0), Act::kEcho);
  round.Echoed({}, 0.0);
  double now = 0.0;
  while (round.Next(now) == Act::kNone) {
    round.Heard(now);
    now += 0.05;
    ASSERT_LT(now, 2.0);
  }
  EXPECT_NEAR(now, 0.1 * AnswerRound::kMostWaits, 0.06);
}

TEST(AnswerRoundTest, ABrokerThatReturnsNothingIsToldAndDelaysNoMore) {
  AnswerRound round({.is_lockstep = true});
  round.Begin();
  ASSERT_EQ(round.Next(0.0), Act::kEcho);
  round.Echoed({0, 1}, 0.0);
  EXPECT_EQ(round.Next(AnswerRound::kLongestEcho - 0.1), Act::kNone);
  EXPECT_EQ(round.Next(AnswerRound::kLongestEcho), Act::kAsk);
  EXPECT_EQ(round.TakeMissing(), 2U);
  EXPECT_EQ(round.TakeMissing(), 0U);
}

TEST(AnswerRoundTest, ARunThatDoesNotWaitHasNoRounds) {
  AnswerRound round({});
  round.Begin();
  EXPECT_TRUE(round.is_over());
  EXPECT_EQ(round.Next(0.0), Act::kNone);
}

}  // namespace
}  // namespace troupe
