#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <vector>

#include "transport/protocol/delivery.h"

namespace troupe {
namespace {

using ::testing::ElementsAre;

constexpr double kLong = 30.0;  // s; only a failing test waits for so long

TEST(DeliveryThread, CallsInTheOrderOfPosting) {
  std::vector<int> calls;
  DeliveryThread delivery;
  const auto first = delivery.AddTarget();
  const auto second = delivery.AddTarget();
  for (int i = 0; i < 4; ++i) delivery.Post(i % 2 == 0 ? first : second, [&calls, i] { calls.push_back(i); });
  delivery.WaitUntilIdle(kLong);
  EXPECT_THAT(calls, ElementsAre(0, 1, 2, 3));
}

TEST(DeliveryThread, CallsTheDelayedLater) {
  std::vector<int> calls;
  std::promise<void> done;
  DeliveryThread delivery;
  const auto target = delivery.AddTarget();
  delivery.Post(
      target,
      [&] {
        calls.push_back(2);
        done.set_value();
      },
      0.02);
  delivery.Post(target, [&] { calls.push_back(1); });
  done.get_future().wait();
  EXPECT_THAT(calls, ElementsAre(1, 2));
}

TEST(DeliveryThread, QueuesTheCallsThatACallPosts) {
  std::vector<int> calls;
  DeliveryThread delivery;
  const auto target = delivery.AddTarget();
  delivery.Post(target, [&] {
    delivery.Post(target, [&] { calls.push_back(2); });
    calls.push_back(1);
  });
  delivery.WaitUntilIdle(kLong);
  EXPECT_THAT(calls, ElementsAre(1, 2));
}

TEST(DeliveryThread, MakesNoCallForARemovedTarget) {
  std::atomic<int> calls = 0;
  DeliveryThread delivery;
  const auto target = delivery.AddTarget();
  const auto other = delivery.AddTarget();
  std::promise<void> running;
  std::promise<void> go_on;
  delivery.Post(other, [&] {
    running.set_value();
    go_on.get_future().wait();
  });
  delivery.Post(target, [&] { ++calls; });
  delivery.Post(
      target, [&] { ++calls; }, 0.001);
  running.get_future().wait();
  delivery.RemoveTarget(target);  // does not wait for the call of another target
  go_on.set_value();
  delivery.WaitUntilIdle(kLong);
  EXPECT_EQ(calls, 0);
}

TEST(DeliveryThread, WaitsForARunningCallOfATargetThatIsRemoved) {
  std::atomic<bool> ended = false;
  DeliveryThread delivery;
  const auto target = delivery.AddTarget();
  std::promise<void> running;
  std::promise<void> go_on;
  delivery.Post(target, [&] {
    running.set_value();
    go_on.get_future().wait();
    ended = true;
  });
  running.get_future().wait();
  auto removed = std::async(std::launch::async, [&] {
    delivery.RemoveTarget(target);
    return ended.load();
  });
  go_on.set_value();
  EXPECT_TRUE(removed.get());
}

TEST(DeliveryThread, MayRemoveATargetFromItsOwnCall) {
  std::atomic<int> calls = 0;
  DeliveryThread delivery;
  const auto target = delivery.AddTarget();
  delivery.Post(target, [&] {
    ++calls;
    delivery.RemoveTarget(target);
    delivery.WaitUntilIdle(kLong);  // returns at once here
  });
  delivery.Post(target, [&] { ++calls; });
  delivery.WaitUntilIdle(kLong);
  EXPECT_EQ(calls, 1);
}

TEST(DeliveryThread, EndsWithCallsStillQueued) {
  DeliveryThread delivery;
  const auto target = delivery.AddTarget();
  delivery.Post(
      target, [] {}, kLong);
}

}  // namespace
}  // namespace troupe
