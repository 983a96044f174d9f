#include "ros/service_bridge/pending_calls.h"

#include <gtest/gtest.h>

#include <vector>

#include "ros/messages/bridge_call.h"

namespace troupe::ros {
namespace {

using std::chrono::seconds;

Caller CallerOf(std::uint8_t client, std::int64_t number) {
  Caller caller;
  caller.endpoint[0] = client;
  caller.number = number;
  return caller;
}

class PendingCallsTest : public testing::Test {
 protected:
  // The numbers of the calls that are sent at this time.
  std::vector<std::int64_t> Send(PendingCalls::Time now) {
    std::vector<std::int64_t> sent;
    calls_.SendDue(
        now, [this](const Guid&) { return can_respond_; },
        [&](std::int64_t number, const Bytes& request) {
          EXPECT_FALSE(request.empty());
          sent.push_back(number);
        });
    return sent;
  }

  PendingCalls calls_;
  PendingCalls::Time start_{};
  bool can_respond_ = true;
};

TEST_F(PendingCallsTest, EachCallerGetsOneResponse) {
  calls_.Add(1, CallerOf(1, 10), {0, 1, 0, 0}, start_);
  calls_.Add(2, CallerOf(2, 20), {0, 1, 0, 0}, start_);
  EXPECT_EQ(Send(start_), (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(calls_.TakeCaller(2), CallerOf(2, 20));
  EXPECT_EQ(calls_.TakeCaller(2), std::nullopt);
  EXPECT_EQ(calls_.TakeCaller(1), CallerOf(1, 10));
  EXPECT_EQ(calls_.TakeCaller(3), std::nullopt);
}

TEST_F(PendingCallsTest, ACallIsRepeatedUntilTheServiceHasAnsweredOne) {
  calls_.Add(1, CallerOf(1, 1), {0, 1, 0, 0}, start_);
  EXPECT_EQ(Send(start_).size(), 1u);
  EXPECT_TRUE(Send(start_).empty());
  ASSERT_TRUE(calls_.NextDue());
  EXPECT_GT(*calls_.NextDue(), start_);
  EXPECT_EQ(Send(start_ + seconds(1)).size(), 1u);
  calls_.ServiceAnswers();
  calls_.Add(2, CallerOf(1, 2), {0, 1, 0, 0}, start_ + seconds(1));
  EXPECT_EQ(Send(start_ + seconds(1)), std::vector<std::int64_t>{2});
  EXPECT_EQ(Send(start_ + seconds(9)), std::vector<std::int64_t>{1}) << "it may have been lost";
  calls_.ServiceChanges();
  calls_.Add(3, CallerOf(1, 3), {0, 1, 0, 0}, start_ + seconds(9));
  EXPECT_EQ(Send(start_ + seconds(9)), std::vector<std::int64_t>{3});
  EXPECT_EQ(Send(start_ + seconds(20)), std::vector<std::int64_t>{3});
}

TEST_F(PendingCallsTest, ACallIsNotRepeatedForever) {
  calls_.Add(1, CallerOf(1, 1), {0, 1, 0, 0}, start_);
  int sent = 0;
  for (int second = 0; second < 100; ++second) sent += static_cast<int>(Send(start_ + seconds(second)).size());
  EXPECT_GT(sent, 3);
  EXPECT_LT(sent, 10);
  EXPECT_EQ(calls_.NextDue(), std::nullopt);
  EXPECT_EQ(calls_.TakeCaller(1), CallerOf(1, 1)) << "it may be a long one";
}

TEST_F(PendingCallsTest, ACallWaitsForTheReaderOfItsClient) {
  can_respond_ = false;
  calls_.Add(1, CallerOf(1, 1), {0, 1, 0, 0}, start_);
  EXPECT_TRUE(Send(start_).empty());
  can_respond_ = true;
  EXPECT_EQ(Send(start_ + seconds(1)).size(), 1u);
  can_respond_ = false;
  calls_.Add(2, CallerOf(1, 2), {0, 1, 0, 0}, start_);
  EXPECT_TRUE(Send(start_ + PendingCalls::kWaitForReader).empty());
  EXPECT_EQ(calls_.size(), 0u);
}

TEST_F(PendingCallsTest, IsBounded) {
  for (std::size_t i = 1; i <= 2 * PendingCalls::kMost; ++i) {
    calls_.Add(static_cast<std::int64_t>(i), CallerOf(1, 1), {0, 1, 0, 0}, start_);
  }
  EXPECT_EQ(calls_.size(), PendingCalls::kMost);
  EXPECT_EQ(calls_.TakeCaller(1), std::nullopt);
  EXPECT_TRUE(calls_.TakeCaller(PendingCalls::kMost + 1));
  const Bytes large(PendingCalls::kMostBytes / 2, 1);
  for (int i = 1; i <= 10; ++i) calls_.Add(10'000 + i, CallerOf(1, 1), large, start_);
  EXPECT_LE(calls_.size(), 2u);
  calls_.Forget(CallerOf(1, 0).endpoint);
  EXPECT_EQ(calls_.size(), 0u);
}

TEST(RecentBridgeCalls, KnowsRepetitionsOfBridgesOnly) {
  const std::uint64_t bridge = kBridgeMark | 7;
  RecentBridgeCalls recent;
  EXPECT_TRUE(recent.Add(bridge, 1));
  EXPECT_FALSE(recent.Add(bridge, 1));
  EXPECT_TRUE(recent.Add(bridge, 2));
  EXPECT_TRUE(recent.Add(kBridgeMark | 8, 1));
  EXPECT_TRUE(recent.Add(4711, 1));
  EXPECT_TRUE(recent.Add(4711, 1));
  for (std::size_t i = 0; i < RecentBridgeCalls::kKept; ++i) {
    EXPECT_TRUE(recent.Add(bridge, 100 + static_cast<std::int64_t>(i)));
  }
  EXPECT_TRUE(recent.Add(bridge, 1)) << "forgotten";
}

}  // namespace
}  // namespace troupe::ros
