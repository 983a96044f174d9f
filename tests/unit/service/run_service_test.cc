// RunService over the memory transport, with agents that are nothing but handlers.
#include "world-service/service/run_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <future>

#include "common/base/version.h"
#include "common/protocol/memory_transport.h"
#include "tests/unit/service/coordinator_fixture.h"

namespace troupe {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

// Joins for one robot, and answers each frame with the same twist.
class SteadyAgent final : public AgentHandler {
 public:
  SteadyAgent(Transport& transport, std::size_t robot)
      : robot_(robot), endpoint_(transport.MakeAgentEndpoint(robot + 1)) {
    endpoint_->Start(*this);
  }
  void OnSession(const SessionMessage& session) override {
    run_ = session.run;
    endpoint_->SendJoin(
        {run_, robot_ + 1, kProtocolVersion, Hash(session.world), "here", 1, {session.world.robots[robot_].name}});
  }
  void OnAdmission(const AdmissionMessage&) override {}
  void OnFrame(const FrameMessage& frame) override {
    if (on_frame) on_frame(frame);
    if (frame.last || frame.state.tick >= silent_from) return;
    endpoint_->SendProposal({run_, robot_ + 1, frame.state.tick + 1, {{RobotId(robot_), {1.0, 0, 0}}}, {}});
  }
  void OnServiceGone() override { gone.set_value(); }

  std::function<void(const FrameMessage&)> on_frame;
  std::atomic<Tick> silent_from = 1000000;
  std::promise<void> gone;

 private:
  const std::size_t robot_;
  std::unique_ptr<AgentEndpoint> endpoint_;
  RunId run_ = 0;
};

class RunServiceTest : public testing::Test, protected RunObserver {
 protected:
  RunServiceTest() : scene_(test::PlaneWorld(2)) {
    options_.settings.ticks = 20;
    options_.start_timeout_seconds = 30.0;
  }
  Result<RunSummary> Run() { return RunService(scene_, options_, transport_->MakeServiceEndpoint(), *this, stop_); }

  void OnStarted(double) override { told_.push_back("started"); }
  void OnStatus(const StatusMessage& status) override {
    last_status_ = status;
    if (on_status_) on_status_();
  }
  void OnEvent(const Event&, const std::string& text) override { told_.push_back(text); }
  void OnNotice(const std::string& text) override { told_.push_back(text); }

  Scene scene_;
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
  const Result<RunSummary> summary = Run();
  ASSERT_TRUE(summary.ok()) << summary.error().ToString();
  EXPECT_EQ(summary.value().ticks, 20u);
  EXPECT_EQ(summary.value().robots, 2u);
  EXPECT_FALSE(summary.value().interrupted);
  EXPECT_EQ(last_status_.tick, 20u);
  EXPECT_THAT(told_, Contains("started"));
  EXPECT_THAT(told_, Contains("tick 0: r1 has an agent (here, pid 1)"));
  first.gone.get_future().wait();
}

TEST_F(RunServiceTest, StopsWhenTold) {
  options_.settings.ticks.reset();
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  on_status_ = [&] { stop_ = true; };
  const Result<RunSummary> summary = Run();
  ASSERT_TRUE(summary.ok());
  EXPECT_TRUE(summary.value().interrupted);
  EXPECT_GT(summary.value().ticks, 0u);
}

TEST_F(RunServiceTest, StopsWhenToldWhileItWaitsForAgents) {
  stop_ = true;
  const Result<RunSummary> summary = Run();
  ASSERT_TRUE(summary.ok());
  EXPECT_TRUE(summary.value().interrupted);
}

TEST_F(RunServiceTest, FailsWhenAnAgentDoesNotCome) {
  options_.start_timeout_seconds = 0.1;
  SteadyAgent first(*transport_, 0);
  const Result<RunSummary> summary = Run();
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.error().message, HasSubstr("r1"));
}

TEST_F(RunServiceTest, GoesOnWithoutAnAgentThatFallsSilent) {
  options_.settings.agent_deadline_seconds = 0.2;
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  second.silent_from = 5;
  const Result<RunSummary> summary = Run();
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().ticks, 20u);
  EXPECT_THAT(summary.value().lost, testing::ElementsAre("r1"));
}

TEST_F(RunServiceTest, OneOfTwoServicesThatGatherAgentsInOneSessionGivesUp) {
  const Scene scene(test::PlaneWorld(2));
  class Nobody final : public RunObserver {
   public:
    void OnStarted(double) override {}
    void OnStatus(const StatusMessage&) override {}
    void OnEvent(const Event&, const std::string&) override {}
  } nobody;
  options_.settings.ticks.reset();
  const auto run = [&] {
    return std::async(std::launch::async, [&] {
      Result<RunSummary> result = RunService(scene, options_, transport_->MakeServiceEndpoint(), nobody, stop_);
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

TEST_F(RunServiceTest, FailsWhenAnOutputFileCannotBeWritten) {
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  options_.outputs.hash_log = "/dev/full";
  Result<RunSummary> summary = Run();
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.error().ToString(), HasSubstr("/dev/full"));
  options_.outputs.hash_log = "/nowhere/at/all";
  summary = Run();
  ASSERT_FALSE(summary.ok());
}

TEST_F(RunServiceTest, PacesTicksWithoutLosingThem) {
  options_.settings.speed = 50.0;  // 2 ms a tick
  SteadyAgent first(*transport_, 0);
  SteadyAgent second(*transport_, 1);
  const Result<RunSummary> summary = Run();
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary.value().ticks, 20u);
  EXPECT_GE(summary.value().wall_seconds, 0.0399);
}

}  // namespace
}  // namespace troupe
