// The contract of every transport's observers. Include it beside transport_contract.h.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "common/model/states.h"
#include "tests/contract/transport_contract.h"
#include "transport/protocol/delivery.h"

namespace troupe::test {

class ObserverContract : public TransportContract {
 protected:
  static constexpr std::size_t kRobots = 20;

  // A service that has begun to publish. Its frames differ in all robots, and seldom travel as a whole.
  class Publisher {
   public:
    explicit Publisher(TransportRig& rig) : endpoint_(rig.ForService().MakeServiceEndpoint()) {
      endpoint_->Start(handler_);
      endpoint_->SendSession(SomeSession(77));
      PublishTick();
    }
    void PublishTick() {
      ++tick_;
      endpoint_->SendFrame(Frame(tick_));
    }
    void PublishTicks(int count) {
      for (int i = 0; i < count; ++i) PublishTick();
    }
    static FrameMessage Frame(Tick tick) {
      FrameMessage frame = SomeFrame(tick, kRobots);
      for (RobotState& robot : frame.state.robots) robot.X_WR.x += 0.01 * static_cast<double>(tick);
      return frame;
    }
    Tick tick() const { return tick_; }
    ServiceEndpoint& endpoint() { return *endpoint_; }
    void End() { endpoint_.reset(); }

   private:
    CollectingService handler_;
    std::unique_ptr<ServiceEndpoint> endpoint_;
    Tick tick_ = 0;
  };

  // An observer that started.
  struct Observer {
    explicit Observer(TransportRig& rig) : Observer(rig, {}) {}
    Observer(TransportRig& rig, std::function<void(const FrameMessage&)> on_frame)
        : endpoint(rig.ForObserver().MakeObserverEndpoint()) {
      handler.on_frame = std::move(on_frame);
      endpoint->Start(handler);
    }
    // The frame of the tick arrives by itself; where the transport loses it, after some requests.
    bool Sees(Tick tick) {
      const auto is_wanted = [tick](const FrameMessage& frame) { return frame.state.tick == tick; };
      return handler.frames.WaitFor(GetParam().loses ? kRepeat : kPatience / 10, is_wanted) ||
             SendUntil(
                 handler.frames, [&] { endpoint->RequestFrame(); }, is_wanted);
    }

    CollectingObserver handler;
    std::unique_ptr<ObserverEndpoint> endpoint;
  };

  // Keeps a handler call from returning until the test opens it, which it must do before the observer ends.
  class Gate {
   public:
    void Wait() {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return open_; });
    }
    void Open() {
      const std::lock_guard lock(mutex_);
      open_ = true;
      changed_.notify_all();
    }

   private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool open_ = false;
  };

  static void ExpectFramesAsPublished(const CollectingObserver& observer) {
    for (const FrameMessage& frame : observer.frames.items()) {
      const FrameMessage published = Publisher::Frame(frame.state.tick);
      EXPECT_EQ(frame.state, published.state);
      EXPECT_EQ(frame.state_hash, published.state_hash);
      EXPECT_EQ(frame.events, published.events);
    }
  }
};

TEST_P(ObserverContract, ALateObserverSeesTheNewestFrameThoughNoOtherFollows) {
  Publisher service(*rig_);
  service.PublishTicks(49);
  Observer observer(*rig_);
  EXPECT_TRUE(observer.handler.sessions.WaitFor(
      kPatience, [](const SessionMessage& session) { return Hash(session.world) == Hash(BusyWorld()); }));
  EXPECT_TRUE(observer.Sees(50));
  ExpectFramesAsPublished(observer.handler);
}

TEST_P(ObserverContract, AnObserverThatIsEarlySeesTheRunBegin) {
  Observer observer(*rig_);
  Publisher service(*rig_);
  EXPECT_TRUE(observer.Sees(1));
  service.PublishTick();
  EXPECT_TRUE(observer.Sees(2));
  ExpectFramesAsPublished(observer.handler);
}

TEST_P(ObserverContract, FramesAfterJoiningHaveTheWholeState) {
  Publisher service(*rig_);
  service.PublishTicks(4);
  Observer observer(*rig_);
  ASSERT_TRUE(observer.Sees(5));
  for (int i = 0; i < 10; ++i) {
    service.PublishTick();
    EXPECT_TRUE(observer.Sees(service.tick()));
  }
  ExpectFramesAsPublished(observer.handler);
}

TEST_P(ObserverContract, StatusAndTheEndOfTheServiceAreSeen) {
  Publisher service(*rig_);
  Observer observer(*rig_);
  ASSERT_TRUE(observer.handler.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; }));
  StatusMessage status{.run = 77, .tick = 1, .waiting_for = {"r3"}};
  EXPECT_TRUE(SendUntil(
      observer.handler.statuses, [&] { service.endpoint().SendStatus(status); },
      [&](const StatusMessage& came) { return came == status; }));
  EXPECT_TRUE(observer.handler.service_gone.items().empty());
  service.End();
  EXPECT_TRUE(observer.handler.service_gone.WaitFor(kPatience, [](bool) { return true; }));
}

TEST_P(ObserverContract, ABlockedObserverDelaysNeitherServiceNorAgentsNorObservers) {
  Gate gate;
  Publisher service(*rig_);
  Observer blocked(*rig_, [&gate](const FrameMessage&) { gate.Wait(); });
  EXPECT_TRUE(blocked.Sees(1));  // it is inside its handler now
  Observer other(*rig_);
  CollectingAgent agent;
  const auto agent_endpoint = rig_->ForAgent().MakeAgentEndpoint(5);
  agent_endpoint->Start(agent);
  EXPECT_TRUE(other.Sees(1));
  service.PublishTicks(3 * static_cast<int>(ObserverQueue::kFramesQueued));
  const Tick newest = service.tick();
  EXPECT_TRUE(SendUntil(
      agent.frames, [&] { service.endpoint().SendFrame(Publisher::Frame(newest)); },
      [&](const FrameMessage& frame) { return frame.state.tick == newest; }));
  EXPECT_TRUE(other.Sees(newest));
  for (const FrameMessage& frame : blocked.handler.frames.items()) EXPECT_EQ(frame.state.tick, 1u);
  gate.Open();
  EXPECT_TRUE(blocked.Sees(newest));
  ExpectFramesAsPublished(blocked.handler);
}

TEST_P(ObserverContract, AnObserverMayEndAtAnyTime) {
  Publisher service(*rig_);
  std::atomic<bool> over = false;
  std::thread publisher([&] {
    while (!over) {
      service.PublishTick();
      std::this_thread::yield();
    }
  });
  for (int i = 0; i < 3; ++i) {
    // A delivery after the end of the endpoint would write to freed memory, which sanitizers report.
    auto handler = std::make_unique<CollectingObserver>();
    auto endpoint = rig_->ForObserver().MakeObserverEndpoint();
    handler->on_frame = [raw = endpoint.get()](const FrameMessage&) { raw->RequestFrame(); };
    endpoint->Start(*handler);
    EXPECT_TRUE(handler->frames.WaitFor(kPatience, [](const FrameMessage&) { return true; }));
    endpoint.reset();
  }
  over = true;
  publisher.join();
}

TEST_P(ObserverContract, AHundredObserversSeeTheRun) {
  Publisher service(*rig_);
  std::vector<std::unique_ptr<Observer>> observers;
  for (int i = 0; i < 100; ++i) observers.push_back(std::make_unique<Observer>(*rig_));
  service.PublishTicks(10);
  for (const auto& observer : observers) {
    EXPECT_TRUE(observer->Sees(service.tick()));
    ExpectFramesAsPublished(observer->handler);
  }
}

TEST_P(ObserverContract, ObserversDoNotChangeARun) {
  WholeRun run{{{"r0"}, {"r1", "r2"}, {"r3"}}, true, GetParam().ticks};
  const WholeRunResult alone = RunBusyWorld(*rig_, run);
  ASSERT_FALSE(alone.hash_log.empty());
  std::map<Tick, std::uint64_t> hashes;
  std::istringstream lines(alone.hash_log);
  for (std::string tick, hash; lines >> tick >> hash;) {
    hashes[std::stoull(tick)] = std::strtoull(hash.c_str(), nullptr, 16);
  }

  const std::unique_ptr<TransportRig> rig = GetParam().make();
  Gate gate;
  std::unique_ptr<Observer> late;
  std::unique_ptr<Observer> ended = std::make_unique<Observer>(*rig);
  Observer blocked(*rig, [&gate](const FrameMessage&) { gate.Wait(); });
  Observer follower(*rig);
  std::thread visitor([&] {  // joins and leaves in the middle of the run
    ended->handler.frames.WaitFor(kPatience, [](const FrameMessage&) { return true; });
    ended.reset();
    late = std::make_unique<Observer>(*rig);
  });
  // An observer that starts before the service discovers it when it announces itself again: a short run would be over.
  run.before_agents = [&follower] {
    follower.handler.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; });
  };
  const WholeRunResult observed = RunBusyWorld(*rig, run);
  visitor.join();
  gate.Open();
  EXPECT_EQ(observed.hash_log, alone.hash_log);
  EXPECT_EQ(observed.summary.rejected, 0u);
  EXPECT_THAT(observed.summary.lost, testing::IsEmpty());
  EXPECT_TRUE(follower.handler.service_gone.WaitFor(kPatience, [](bool) { return true; }));
  EXPECT_FALSE(follower.handler.frames.items().empty());
  for (Observer* observer : {&follower, late.get()}) {
    for (const FrameMessage& frame : observer->handler.frames.items()) {
      EXPECT_EQ(StateHash(frame.state), frame.state_hash);
      EXPECT_EQ(hashes[frame.state.tick], frame.state_hash) << "tick " << frame.state.tick;
    }
  }
}

}  // namespace troupe::test
