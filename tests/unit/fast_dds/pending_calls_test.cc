#include "ros/fast_dds/pending_calls.h"

#include <gtest/gtest.h>

#include <vector>

namespace troupe::ros {
namespace {

using std::chrono::seconds;
using Calls = PendingCalls<int>;

const Bytes kRequest = {0, 1, 0, 0};

class PendingCallsTest : public testing::Test {
 protected:
  // The numbers of the calls that are sent now.
  std::vector<std::int64_t> Send() {
    std::vector<std::int64_t> sent;
    calls_.SendReady([this](int) { return can_respond_; },
                     [&](std::int64_t number, const Bytes& request) {
                       EXPECT_EQ(request, kRequest);
                       sent.push_back(number);
                     });
    return sent;
  }

  Calls calls_;
  Calls::Time start_{};
  bool can_respond_ = true;
};

TEST_F(PendingCallsTest, EachCallerGetsOneResponse) {
  calls_.Add(1, {1, 10}, kRequest, start_);
  calls_.Add(2, {2, 20}, kRequest, start_);
  EXPECT_EQ(Send(), (std::vector<std::int64_t>{1, 2}));
  EXPECT_TRUE(Send().empty());
  const auto second = calls_.TakeCaller(2);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->endpoint, 2);
  EXPECT_EQ(second->number, 20);
  EXPECT_FALSE(calls_.TakeCaller(2));
  EXPECT_TRUE(calls_.TakeCaller(1));
  EXPECT_FALSE(calls_.TakeCaller(3));
}

TEST_F(PendingCallsTest, ACallWaitsForTheReaderOfItsClient) {
  can_respond_ = false;
  calls_.Add(1, {1, 1}, kRequest, start_);
  EXPECT_TRUE(Send().empty());
  can_respond_ = true;
  EXPECT_EQ(Send(), std::vector<std::int64_t>{1});
  can_respond_ = false;
  calls_.Add(2, {1, 2}, kRequest, start_);
  calls_.TakeCaller(1);
  calls_.Add(3, {2, 3}, kRequest, start_ + Calls::kWaitForReader);
  can_respond_ = true;
  EXPECT_EQ(Send(), std::vector<std::int64_t>{3}) << "the other client has no reader";
}

TEST_F(PendingCallsTest, IsBounded) {
  for (std::size_t i = 1; i <= 2 * Calls::kMost; ++i) {
    calls_.Add(static_cast<std::int64_t>(i), {1, 1}, kRequest, start_);
  }
  EXPECT_EQ(calls_.size(), Calls::kMost);
  EXPECT_FALSE(calls_.TakeCaller(1));
  EXPECT_TRUE(calls_.TakeCaller(Calls::kMost + 1));
  const Bytes large(Calls::kMostBytes / 2, 1);
  for (int i = 1; i <= 10; ++i) calls_.Add(10'000 + i, {1, 1}, large, start_);
  EXPECT_LE(calls_.size(), 2u);
  calls_.Forget(1);
  EXPECT_EQ(calls_.size(), 0u);
}

}  // namespace
}  // namespace troupe::ros
