#include <gtest/gtest.h>

#include <latch>

#include "tests/contract/collecting_handlers.h"
#include "transport/protocol/delivery.h"

namespace troupe {
namespace {

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

}  // namespace
}  // namespace troupe
