// RunService over the memory transport, with agents that are nothing but handlers.
#include "world-service/service/run_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <optional>
#include <stdexcept>

#include "tests/support/values.h"
#include "tests/unit/service/coordinator_fixture.h"
#include "tests/unit/service/steady_agent.h"
#include "transport/protocol/transport.h"

namespace troupe {
namespace {

using test::SteadyAgent;
using ::testing::Contains;
using ::testing::HasSubstr;

class RunServiceTest : public testing::Test, protected RunObserver {
 protected:
  RunServiceTest() : scene_(std::make_shared<const Scene>(test::PlaneWorld(2))) {
    options_.settings.ticks = 20;
    options_.start_timeout_seconds = 30.0;
  }
  Result<RunSummary> Run() {
    return RunService(scene_, options_, transport_->MakeServiceEndpoint(), observers_, stop_);
  }

  void OnStarted(double) override { told_.push_back("started"); }
  void OnStatus(const StatusMessage& status) override {
    last_status_ = status;
    if (on_status_) on_status_();
  }
  void OnEvent(const Event&, const std::string& text) override { told_.push_back(text); }
  void OnNotice(const std::string& text) override { told_.push_back(text); }

  const std::shared_ptr<const Scene> scene_;
  RunObservers observers_ = {this};
  ServiceOptions options_;
  std::atomic<bool> stop_ = false;
  std::unique_ptr<Transport> transport_ = MakeMemoryTransport();
  std::vector<std::string> told_;
  StatusMessage last_status_;
  std::function<void()> on_status_;
};

TEST_F(RunServiceTest, RunsToTheEnd) {
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  const RunSummary summary = test::ValueOf(Run());
  EXPECT_EQ(summary.ticks, 20u);
  EXPECT_EQ(summary.robots, 2u);
  EXPECT_FALSE(summary.interrupted);
  EXPECT_EQ(last_status_.tick, 20u);
  EXPECT_THAT(told_, Contains("started"));
  EXPECT_THAT(told_, Contains("tick 0: r1 has an agent (here, pid 1)"));
  first.gone.get_future().wait();
}

TEST_F(RunServiceTest, StopsOnRequest) {
  options_.settings.ticks.reset();
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  on_status_ = [&] { stop_ = true; };
  const RunSummary summary = test::ValueOf(Run());
  EXPECT_TRUE(summary.interrupted);
  EXPECT_GT(summary.ticks, 0u);
}

TEST_F(RunServiceTest, StopsOnRequestWhileItWaitsForAgents) {
  stop_ = true;
  EXPECT_TRUE(test::ValueOf(Run()).interrupted);
}

TEST_F(RunServiceTest, FailsWhenAnAgentDoesNotJoin) {
  options_.start_timeout_seconds = 0.1;
  SteadyAgent first(*transport_, 0);
  const Result<RunSummary> summary = Run();
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.error().message, HasSubstr("r1"));
}

TEST_F(RunServiceTest, ContinuesWithoutAnAgentThatFallsSilent) {
  options_.settings.agent_deadline_seconds = 0.2;
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  second.silent_from = 5;
  const RunSummary summary = test::ValueOf(Run());
  EXPECT_EQ(summary.ticks, 20u);
  EXPECT_THAT(summary.lost, testing::ElementsAre("r1"));
}

TEST_F(RunServiceTest, OneOfTwoServicesThatGatherAgentsInOneSessionFails) {
  options_.settings.ticks.reset();
  const auto run = [&] {
    return std::async(std::launch::async, [&] {
      Result<RunSummary> result = RunService(scene_, options_, transport_->MakeServiceEndpoint(), {}, stop_);
      stop_ = true;  // for the other one
      return result;
    });
  };
  auto one = run();
  auto other = run();
  const Result<RunSummary> results[] = {one.get(), other.get()};
  ASSERT_NE(results[0].ok(), results[1].ok());
  EXPECT_THAT(results[results[0].ok() ? 1 : 0].error().message, HasSubstr("another world service"));
}

TEST_F(RunServiceTest, PacesTicksWithoutLosingThem) {
  options_.settings.speed = 50.0;  // 2 ms a tick
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  const RunSummary summary = test::ValueOf(Run());
  EXPECT_EQ(summary.ticks, 20u);
  EXPECT_GE(summary.wall_seconds, 0.0399);
}

// Delivers one message for which there was no memory.
class ForgetfulEndpoint final : public ServiceEndpoint {
 public:
  void Start(ServiceHandler& handler) override { handler.OnOutOfMemory(); }
  void SendSession(const SessionMessage&) override {}
  void SendAdmissions(const std::vector<AdmissionMessage>&) override {}
  void SendFrame(const FrameMessage&) override {}
  void SendHistory(const HistoryMessage&) override {}
  void SendStatus(const StatusMessage&) override {}
  void Flush(double) override {}
};

TEST_F(RunServiceTest, EndsInOrderWithoutMemoryForAMessage) {
  const Result<RunSummary> summary =
      RunService(scene_, options_, std::make_unique<ForgetfulEndpoint>(), observers_, stop_);
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().message, "there is not enough memory");
  EXPECT_EQ(summary.error().code, ErrorCode::kFailure);
}

// An observer that throws in one of its calls, at tick 5 if that is one of a tick.
struct Fault {
  std::string call;
  Tick last_sent = 0;  // tick of the last frame that the agents see
};

class FaultyObserverTest : public RunServiceTest, public testing::WithParamInterface<Fault> {
 protected:
  static constexpr Tick kTick = 5;

  Status OnBegin(const RunStart&) override { return ThrowIn("OnBegin"); }
  Status OnCommit(const CommittedTick& tick, const RunProgress&) override {
    return tick.frame.state.tick == kTick ? ThrowIn("OnCommit") : Status();
  }
  Status OnTick(const CommittedTick& tick) override {
    return tick.frame.state.tick == kTick ? ThrowIn("OnTick") : Status();
  }
  bool IsReady() override {
    if (last_status_.tick == 0) (void)ThrowIn("IsReady");
    return true;
  }
  void OnStarted(double) override { (void)ThrowIn("OnStarted"); }
  void OnStatus(const StatusMessage& status) override {
    if (status.tick == 20) (void)ThrowIn("OnStatus");  // the last one
  }
  void OnEvent(const Event&, const std::string&) override { (void)ThrowIn("OnEvent"); }
  Status OnEnd() override {
    ended_ = true;
    return ThrowIn("OnEnd");
  }
  Status ThrowIn(const std::string& call) {
    if (call != GetParam().call) return {};
    throw std::runtime_error("the observer has a fault");
  }

  bool ended_ = false;
};

TEST_P(FaultyObserverTest, EndsTheRunInOrderAndPublishesNothingHalfCommitted) {
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  std::optional<FrameMessage> last;
  first.on_frame = [&](const FrameMessage& frame) { last = frame; };
  const Result<RunSummary> summary = Run();
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.error().message, "the observer has a fault");
  EXPECT_EQ(summary.error().code, ErrorCode::kFailure);
  EXPECT_EQ(ended_, GetParam().call != "OnBegin");
  if (GetParam().call == "OnBegin") return;
  first.gone.get_future().wait();
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->last);
  if (GetParam().last_sent > 0) {
    EXPECT_EQ(last->state.tick, GetParam().last_sent);
  }
}

INSTANTIATE_TEST_SUITE_P(Calls, FaultyObserverTest,
                         testing::Values(Fault{"OnBegin"}, Fault{"OnCommit", 4}, Fault{"OnTick", 5}, Fault{"IsReady"},
                                         Fault{"OnStarted"}, Fault{"OnStatus", 20}, Fault{"OnEvent"},
                                         Fault{"OnEnd", 20}),
                         [](const testing::TestParamInfo<Fault>& fault) { return fault.param.call; });

}  // namespace
}  // namespace troupe
