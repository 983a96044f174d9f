#include "transport/protocol/faulty_transport.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <vector>

#include "tests/support/values.h"
#include "transport/protocol/transport.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;

constexpr Tick kFrames = 1000;

// The ticks of the frames that arrive.
class FrameCounter final : public AgentHandler {
 public:
  void OnSession(const SessionMessage&) override { ++sessions; }
  void OnAdmission(const AdmissionMessage&) override {}
  void OnFrame(const FrameMessage& frame) override {
    const std::lock_guard lock(mutex_);
    ticks_.push_back(frame.state.tick);
    changed_.notify_all();
  }
  void OnServiceGone() override {
    const std::lock_guard lock(mutex_);
    gone_ = true;
    changed_.notify_all();
  }

  // Once the service has ended, so that all messages without a delay have arrived, and there are at least `count`.
  std::vector<Tick> WaitFor(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(30), [&] { return gone_ && ticks_.size() >= count; });
    return ticks_;
  }

  int sessions = 0;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Tick> ticks_;
  bool gone_ = false;
};

class NoService final : public ServiceHandler {
 public:
  void OnJoin(const JoinMessage&) override {}
  void OnProposal(const ProposalMessage&) override {}
  void OnAgentGone(AgentId) override {}
  void OnRivalService(const SessionMessage&) override {}
};

// The frames that arrive of kFrames, sent without a pause; waits for those without a delay, and for `count` in all.
std::vector<Tick> Send(const Faults& faults, std::size_t count = 0) {
  const auto transport = MakeFaultyTransport(MakeMemoryTransport(), faults);
  FrameCounter counter;
  NoService handler;
  auto service = transport->MakeServiceEndpoint();
  service->Start(handler);
  const auto agent = transport->MakeAgentEndpoint(1);
  agent->Start(counter);
  FrameMessage frame;
  for (Tick tick = 1; tick <= kFrames; ++tick) {
    frame.state.tick = tick;
    service->SendFrame(frame);
  }
  service->Flush(30.0);
  service.reset();
  return counter.WaitFor(count);
}

TEST(FaultyTransport, WithoutFaultsDeliversEveryMessageUnchanged) {
  const std::vector<Tick> ticks = Send({});
  ASSERT_EQ(ticks.size(), kFrames);
  EXPECT_TRUE(std::is_sorted(ticks.begin(), ticks.end()));
}

TEST(FaultyTransport, LosesTheGivenShare) {
  Faults faults;
  faults.loss = 0.3;
  const std::vector<Tick> ticks = Send(faults);
  EXPECT_GE(ticks.size(), 600u);
  EXPECT_LE(ticks.size(), 800u);
}

TEST(FaultyTransport, LosesTheSameMessagesForTheSameSeed) {
  Faults faults{.loss = 0.3, .seed = 5};
  EXPECT_EQ(Send(faults), Send(faults));
}

TEST(FaultyTransport, DuplicatesMessages) {
  Faults faults;
  faults.duplicate = 0.5;
  EXPECT_GE(Send(faults).size(), 1400u);
}

TEST(FaultyTransport, ReordersMessages) {
  Faults faults;
  faults.reorder = 0.5;
  const std::vector<Tick> ticks = Send(faults);  // the last one may never be delivered
  EXPECT_GE(ticks.size(), kFrames - 1);
  EXPECT_FALSE(std::is_sorted(ticks.begin(), ticks.end()));
}

TEST(FaultyTransport, DelaysMessagesAndDeliversAllOfThem) {
  Faults faults{.delay_probability = 0.5, .delay_seconds = 0.01};
  std::vector<Tick> ticks = Send(faults, kFrames);
  EXPECT_FALSE(std::is_sorted(ticks.begin(), ticks.end()));
  std::sort(ticks.begin(), ticks.end());
  ASSERT_EQ(ticks.size(), kFrames);
  EXPECT_EQ(ticks.front(), 1u);
  EXPECT_EQ(ticks.back(), kFrames);
}

TEST(ParseFaults, ReadsEveryField) {
  const Faults faults =
      test::ValueOf(ParseFaults("loss=0.1,duplicate=0.05,reorder=0.2,delay=0.3:0.005,latency=0.01:0.2,seed=7"));
  EXPECT_EQ(faults.loss, 0.1);
  EXPECT_EQ(faults.duplicate, 0.05);
  EXPECT_EQ(faults.reorder, 0.2);
  EXPECT_EQ(faults.delay_probability, 0.3);
  EXPECT_EQ(faults.delay_seconds, 0.005);
  EXPECT_EQ(faults.latency_seconds, 0.01);
  EXPECT_EQ(faults.latency_jitter, 0.2);
  EXPECT_EQ(faults.seed, 7u);
}

TEST(ParseFaults, OfAnEmptyTextIsNoFaults) {
  EXPECT_FALSE(test::ValueOf(ParseFaults("")).any());
}

TEST(ParseFaults, NamesTheFoundAndTheExpectedText) {
  for (const char* bad : {"loss", "loss=", "loss=2", "loss=-0.1", "loss=nan", "loss=0.1x", "delay=0.1",
                          "delay=0.1:", "delay=0.1:-1", "delay=2:0.1", "delay=0.1:nan", "latency=-1", "latency=1:2",
                          "latency=x", "seed=-1", "seed=x", "speed=1", "loss=0.1,,"}) {
    const Result<Faults> faults = ParseFaults(bad);
    ASSERT_FALSE(faults.ok()) << bad;
    EXPECT_THAT(faults.error().message, HasSubstr("expected")) << bad;
  }
}

}  // namespace
}  // namespace troupe
