#include "transport/protocol/delivery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <latch>
#include <vector>

#include "tests/contract/transport_case.h"
#include "transport/protocol/tick_barrier.h"

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

std::shared_ptr<const FrameMessage> FrameOf(Tick tick) {
  FrameMessage frame;
  frame.state.tick = tick;
  return std::make_shared<const FrameMessage>(frame);
}

std::shared_ptr<const SessionMessage> SessionOf(RunId run) {
  SessionMessage session;
  session.run = run;
  return std::make_shared<const SessionMessage>(session);
}

// Keeps the order of the calls, and stays in the first one until it is released.
class BlockedObserver final : public ObserverHandler {
 public:
  void OnSession(const SessionMessage& session) override { Keep("session " + std::to_string(session.run)); }
  void OnFrame(const SharedFrame& frame) override { Keep("frame " + std::to_string(frame->state.tick)); }
  void OnStatus(const StatusMessage& status) override { Keep("status " + std::to_string(status.tick)); }
  void OnServiceGone() override { Keep("gone"); }

  std::latch entered{1};
  std::latch released{1};
  test::Inbox<std::string> calls;

 private:
  void Keep(const std::string& call) {
    if (calls.items().empty()) {
      entered.count_down();
      released.wait();
    }
    calls.Put(call);
  }
};

TEST(ObserverQueueTest, ASlowObserverReceivesTheNewestFramesInOrder) {
  BlockedObserver observer;
  ObserverQueue queue(observer);
  queue.PostSession(SessionOf(1));
  observer.entered.wait();
  const Tick newest = ObserverQueue::kFramesQueued + 2;
  for (Tick tick = 1; tick < newest; ++tick) queue.PostFrame(FrameOf(tick));
  queue.PostSession(SessionOf(2));
  for (Tick tick : {1, 2}) {
    StatusMessage status;
    status.tick = tick;
    queue.PostStatus(std::make_shared<const StatusMessage>(status));
  }
  queue.PostFrame(FrameOf(newest));
  queue.PostServiceGone();
  observer.released.count_down();
  ASSERT_TRUE(observer.calls.WaitFor(20.0, [](const std::string& call) { return call == "gone"; }));

  std::vector<std::string> expected = {"session 1"};
  for (Tick tick = 3; tick < newest; ++tick) expected.push_back("frame " + std::to_string(tick));
  for (const std::string call : {"session 2", "status 2"}) expected.push_back(call);
  expected.push_back("frame " + std::to_string(newest));
  expected.push_back("gone");
  EXPECT_EQ(observer.calls.items(), expected);
}

TEST(ObserverQueueTest, NothingIsDeliveredAfterItWasClosed) {
  BlockedObserver observer;
  observer.released.count_down();
  ObserverQueue queue(observer);
  queue.PostFrame(FrameOf(1));
  observer.entered.wait();
  queue.Close();
  queue.PostFrame(FrameOf(2));
  queue.Close();
  EXPECT_EQ(observer.calls.items(), std::vector<std::string>{"frame 1"});
}

TEST(ObserverQueueTest, AnIdleQueueReportsItAgainAndAgain) {
  BlockedObserver observer;
  observer.released.count_down();
  std::latch twice(2);
  ObserverQueue queue(
      observer,
      [&twice] {
        if (!twice.try_wait()) twice.count_down();
      },
      0.001);
  twice.wait();
}

using ::testing::IsEmpty;

TEST(TickBarrier, IsCompleteWithoutMembers) {
  TickBarrier barrier;
  barrier.Open(1);
  EXPECT_TRUE(barrier.complete());
}

TEST(TickBarrier, IsCompleteWhenAllMembersHaveArrived) {
  TickBarrier barrier;
  barrier.AddMember(7);
  barrier.AddMember(3);
  barrier.Open(1);
  EXPECT_FALSE(barrier.complete());
  EXPECT_TRUE(barrier.Arrive(3));
  EXPECT_FALSE(barrier.complete());
  EXPECT_TRUE(barrier.Arrive(7));
  EXPECT_TRUE(barrier.complete());
}

TEST(TickBarrier, NamesTheMissingInIdOrder) {
  TickBarrier barrier;
  for (AgentId agent : {9u, 2u, 5u}) barrier.AddMember(agent);
  barrier.Open(1);
  EXPECT_THAT(barrier.Missing(), ElementsAre(2, 5, 9));
  barrier.Arrive(5);
  EXPECT_THAT(barrier.Missing(), ElementsAre(2, 9));
}

TEST(TickBarrier, CountsAMemberOnceForATick) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.AddMember(2);
  barrier.Open(1);
  EXPECT_TRUE(barrier.Arrive(1));
  EXPECT_FALSE(barrier.Arrive(1));
  EXPECT_THAT(barrier.Missing(), ElementsAre(2));
}

TEST(TickBarrier, IgnoresAgentsThatAreNoMembers) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.Open(1);
  EXPECT_FALSE(barrier.Arrive(2));
  barrier.RemoveMember(2);
  EXPECT_THAT(barrier.Missing(), ElementsAre(1));
}

TEST(TickBarrier, ForgetsAnswersWhenItOpensAgain) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.Open(1);
  barrier.Arrive(1);
  barrier.Open(2);
  EXPECT_EQ(barrier.tick(), 2u);
  EXPECT_THAT(barrier.Missing(), ElementsAre(1));
  EXPECT_TRUE(barrier.Arrive(1));
}

TEST(TickBarrier, WaitsForAMemberThatIsAddedWhileItIsOpen) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.Open(4);
  barrier.Arrive(1);
  barrier.AddMember(2);
  EXPECT_THAT(barrier.Missing(), ElementsAre(2));
  barrier.AddMember(1);  // has arrived, which does not change
  EXPECT_THAT(barrier.Missing(), ElementsAre(2));
}

TEST(TickBarrier, DoesNotWaitForAMemberThatWasRemoved) {
  TickBarrier barrier;
  barrier.AddMember(1);
  barrier.AddMember(2);
  barrier.Open(1);
  barrier.Arrive(2);
  barrier.RemoveMember(2);
  EXPECT_EQ(barrier.missing(), 1u);
  barrier.RemoveMember(1);
  EXPECT_TRUE(barrier.complete());
  EXPECT_THAT(barrier.Missing(), IsEmpty());
  EXPECT_EQ(barrier.members(), 0u);
}

}  // namespace
}  // namespace troupe
