// RunService over the memory transport, with agents that are nothing but handlers.
#include "world-service/service/run_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <optional>
#include <stdexcept>
#include <thread>

#include "tests/support/values.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "tests/unit/world-service/service/live_run_fixture.h"
#include "transport/protocol/faulty_transport.h"
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

  void OnStarted(double) override { reports_.push_back("started"); }
  void OnStatus(const StatusMessage& status) override {
    last_status_ = status;
    if (on_status_) on_status_();
  }
  void OnEvent(const Event&, const std::string& text) override { reports_.push_back(text); }
  void OnNotice(const std::string& text) override { reports_.push_back(text); }

  const std::shared_ptr<const Scene> scene_;
  RunObservers observers_ = {this};
  ServiceOptions options_;
  std::atomic<bool> stop_ = false;
  std::unique_ptr<Transport> transport_ = MakeMemoryTransport();
  std::vector<std::string> reports_;
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
  EXPECT_THAT(reports_, Contains("started"));
  // A line of its own, or one with the other agent, which has the same process here.
  EXPECT_THAT(reports_, Contains(testing::AllOf(HasSubstr("r1"), HasSubstr("an agent (here, pid 1)"))));
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
  transport_ = MakeFaultyTransport(std::move(transport_), {});  // in one process no agent is lost by its silence
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

// Wakes the run when it begins itself, before the others.
class WakingObserver final : public RunObserver {
  Status OnBegin(const RunStart& start) override {
    std::thread([&start] { start.control.Wake(); }).join();
    return {};
  }
};

// Of a world without robots all have joined from the start.
TEST_F(RunServiceTest, ARunThatIsWokenEarlyBeginsAfterAllObservers) {
  class Begun final : public RunObserver {
   public:
    bool has_begun = false;
    bool saw_tick_before = false;

   private:
    Status OnBegin(const RunStart&) override {
      has_begun = true;
      return {};
    }
    Status OnTick(const CommittedTick&) override {
      saw_tick_before = saw_tick_before || !has_begun;
      return {};
    }
  };
  WakingObserver waking;
  Begun late;
  const auto empty = std::make_shared<const Scene>(test::PlaneWorld(0));
  EXPECT_EQ(
      test::ValueOf(RunService(empty, options_, transport_->MakeServiceEndpoint(), {&waking, &late}, stop_)).ticks,
      20u);
  EXPECT_TRUE(late.has_begun);
  EXPECT_FALSE(late.saw_tick_before);
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

// A coordinator that continues a run from its newest state.

using test::CoordinatorTest;
using ::testing::IsEmpty;
using Phase = TickCoordinator::Phase;

// Keeps what another coordinator needs to continue the run.
class KeptJournal final : public RunObserver {
 public:
  Status OnCommit(const CommittedTick& tick, const RunProgress& newest) override {
    frame = tick.frame;
    frame->commands.clear();  // of the tick to come, which a journal does not have
    return OnProgress(newest);
  }
  Status OnProgress(const RunProgress& newest) override {
    progress = newest;
    return {};
  }

  std::optional<FrameMessage> frame;
  RunProgress progress;
};

class ResumedRunTest : public CoordinatorTest {
 protected:
  ResumedRunTest() { observers = {&journal_}; }

  // The service dies, and another one continues: without any agent.
  void Resume() {
    ResumedRun resumed{.run = kRun, .incarnation = journal_.progress.incarnation + 1};
    resumed.original = resumed.scene = scene;
    resumed.frame = journal_.frame;
    resumed.progress = journal_.progress;
    resumed.next_number = ++next_number_;
    options.resumed = resumed;
    options.incarnation = resumed.incarnation;
    endpoint = {};
    coordinator.emplace(scene, options, endpoint, observers, now);
    coordinator->Announce();
  }
  void Rejoin(AgentId agent, Incarnation incarnation = 1) {
    JoinMessage join = JoinOf(agent, {"r" + std::to_string(agent - 1)});
    join.incarnation = incarnation;
    coordinator->OnJoin(join, now);
  }
  void ProposeAs(Incarnation incarnation, AgentId agent) {
    ProposalMessage proposal = ProposalOf(agent, 1.0);
    proposal.incarnation = incarnation;
    coordinator->OnProposal(proposal, now);
  }

  std::uint64_t next_number_ = 0;
  KeptJournal journal_;
};

TEST_F(ResumedRunTest, BeginsWithTheNewestFrameWhenAllAgentsAreBack) {
  MakeAndStart(2);
  Propose(1);
  Propose(2);
  const FrameMessage newest = endpoint.frames.back();
  Resume();
  EXPECT_TRUE(endpoint.sessions.back().begun);
  EXPECT_EQ(endpoint.sessions.back().incarnation, 1u);
  Rejoin(1);
  EXPECT_THAT(endpoint.frames, IsEmpty());
  Rejoin(2);
  ASSERT_EQ(endpoint.frames.size(), 1u);
  EXPECT_EQ(endpoint.frames.back().state, newest.state);
  EXPECT_EQ(endpoint.frames.back().state_hash, newest.state_hash);
  ProposeAs(1, 1);
  ProposeAs(1, 2);
  EXPECT_EQ(tick(), 2u);
  EXPECT_NEAR(Travel(0), 0.2, 1e-12);
}

TEST_F(ResumedRunTest, ExecutesCommandsOnceAllAgentsAreBack) {
  MakeAndStart(1);
  Resume();
  std::vector<ControlReply> replies;
  const auto reply = [&replies](const ControlReply& one) { replies.push_back(one); };
  coordinator->Control(control::CommandRobot{.name = "r0", .ticks = 3, .twist = Twist{0.5, 0.0, 0.0}}, reply, now);
  EXPECT_THAT(replies, IsEmpty());
  Rejoin(1);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].done) << replies[0].problem;
}

// What a tool was told holds, though the service dies before the agents are back.
TEST_F(ResumedRunTest, PlaysAndKeepsItsSpeedAfterTwoDeaths) {
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  std::vector<ControlReply> replies;
  const auto reply = [&replies](const ControlReply& one) { replies.push_back(one); };
  coordinator->Control(control::Pause{}, reply, now);
  Propose(1);
  ASSERT_TRUE(endpoint.frames.back().paused);
  Resume();
  replies.clear();
  coordinator->Control(control::Speed{.speed = 3.0}, reply, now);
  coordinator->Control(control::Play{}, reply, now);
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_TRUE(replies[1].done);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  Resume();
  Rejoin(1, 2);
  ASSERT_EQ(coordinator->phase(), Phase::kRunning) << "the other agent was lost before, and is not waited for";
  EXPECT_FALSE(endpoint.frames.back().paused);
  EXPECT_EQ(journal_.progress.speed, 3.0);
}

TEST_F(ResumedRunTest, IgnoresMessagesForTheServiceBefore) {
  MakeAndStart(1);
  Resume();
  Rejoin(1, 0);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  Rejoin(1);
  ASSERT_EQ(coordinator->phase(), Phase::kRunning);
  ProposeAs(0, 1);
  EXPECT_EQ(tick(), 0u);
  ProposeAs(1, 1);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(ResumedRunTest, HasTheCommandsInForce) {
  control::CommandRobot request;
  request.ticks = 3;
  MakeAndStart(2);
  request.name = "r0";
  request.twist = Twist{0.5, 0.0, 0.0};
  ASSERT_TRUE(Ask(request).done);
  Propose(1);
  Propose(2);
  request.name = "r1";
  ASSERT_TRUE(Ask(request).done) << "it arrives after the newest frame was sent";
  const std::vector<RobotCommand> sent = endpoint.frames.back().commands;
  ASSERT_EQ(sent.size(), 1u);
  Resume();
  Rejoin(1);
  Rejoin(2);
  ASSERT_FALSE(endpoint.frames.empty());
  EXPECT_EQ(endpoint.frames.back().commands, sent) << "an agent may have answered this frame";
  std::vector<std::size_t> counts;
  for (int i = 0; i < 4; ++i) {
    ProposeAs(1, 1);
    ProposeAs(1, 2);
    counts.push_back(endpoint.frames.back().commands.size());
  }
  EXPECT_THAT(counts, ::testing::ElementsAre(2u, 2u, 1u, 0u));
}

TEST_F(ResumedRunTest, HasTheSpeedThatWasSet) {
  control::Speed request;
  request.speed = 0.25;
  MakeAndStart(1);
  EXPECT_EQ(coordinator->MakeStatus(now).speed, std::nullopt);
  ASSERT_TRUE(Ask(request).done);
  Resume();
  EXPECT_EQ(coordinator->MakeStatus(now).speed, 0.25);
  Rejoin(1);
  request.speed.reset();
  ASSERT_TRUE(Ask(request).done);
  options.settings.speed = 2.0;
  Resume();
  EXPECT_EQ(coordinator->MakeStatus(now).speed, std::nullopt);
}

TEST_F(ResumedRunTest, ANewGoalHasAnotherNumberThanThoseBefore) {
  const auto next_goal = [this](Incarnation incarnation) {
    control::CommandRobot request{.name = "r0", .ticks = 10};
    request.goal = Goal{0, {{1.0, 2.0}}};
    EXPECT_TRUE(Ask(request).done);
    ProposeAs(incarnation, 1);
    return endpoint.frames.back().commands.at(0).goal->number;
  };
  Make(1);
  JoinMessage join = JoinOf(1, {"r0"});
  join.accept_goals = {"r0"};
  coordinator->OnJoin(join, now);
  const std::uint32_t before = next_goal(0);
  Resume();
  join.incarnation = 1;
  coordinator->OnJoin(join, now);
  EXPECT_NE(next_goal(1), before);
}

TEST_F(ResumedRunTest, IsPausedIfTheRunWas) {
  MakeAndStart(1);
  control::Pause pause;
  coordinator->Control(
      pause, [](const ControlReply&) {}, now);
  Propose(1);
  ASSERT_TRUE(endpoint.frames.back().paused);
  Resume();
  Rejoin(1);
  EXPECT_TRUE(endpoint.frames.back().paused);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(ResumedRunTest, FinishesAStep) {
  options.start_paused = true;
  MakeAndStart(1);
  ProposalMessage paused = ProposalOf(1, 0.0);
  paused.proposals.clear();
  paused.paused = true;
  coordinator->OnProposal(paused, now);
  control::Step step{.ticks = 3};
  coordinator->Control(
      step, [](const ControlReply&) {}, now);
  Propose(1);
  ASSERT_EQ(tick(), 1u);
  Resume();
  Rejoin(1);
  ProposeAs(1, 1);
  EXPECT_FALSE(endpoint.frames.back().paused);
  ProposeAs(1, 1);
  EXPECT_TRUE(endpoint.frames.back().paused);
  EXPECT_EQ(tick(), 3u);
}

TEST_F(ResumedRunTest, DoesNotWaitForARobotThatHadLostItsAgent) {
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  Propose(1);
  ASSERT_EQ(tick(), 1u);
  Resume();
  Rejoin(1);
  EXPECT_EQ(coordinator->phase(), Phase::kRunning);
}

// A pause has no tick that tells the journal.
TEST_F(ResumedRunTest, WaitsForARobotThatHasRejoinedInAPause) {
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  coordinator->Control(
      control::Pause{}, [](const ControlReply&) {}, now);
  Propose(1);
  ASSERT_TRUE(endpoint.frames.back().paused);
  Rejoin(2, 0);
  coordinator->Poll(now);
  Resume();
  Rejoin(1);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  Rejoin(2);
  EXPECT_EQ(coordinator->phase(), Phase::kRunning);
}

TEST_F(ResumedRunTest, LosesAgentsThatDoNotReturn) {
  MakeAndStart(2);
  Resume();
  Rejoin(1);
  Wait(options.start_timeout_seconds - 1.0);
  EXPECT_EQ(coordinator->phase(), Phase::kGathering);
  EXPECT_GT(endpoint.sessions.size(), 1u) << "it is announced again";
  Wait(1.5);
  EXPECT_EQ(coordinator->phase(), Phase::kRunning);
  EXPECT_THAT(Events(), testing::Contains("left r1"));
  ProposeAs(1, 1);
  EXPECT_EQ(tick(), 1u);
}

TEST_F(ResumedRunTest, EndsARunWhoseLastTickWasCommitted) {
  options.settings.ticks = 1;
  MakeAndStart(1);
  Propose(1);
  ASSERT_TRUE(endpoint.frames.back().last);
  Resume();
  Rejoin(1);
  ASSERT_FALSE(endpoint.frames.empty());
  EXPECT_TRUE(endpoint.frames.back().last);
  EXPECT_EQ(coordinator->phase(), Phase::kEnding);
  // Its agents may have left before.
  Resume();
  Wait(2.0 * options.lease_seconds + 0.1);
  Wait(1.1);
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
  EXPECT_TRUE(coordinator->error().ok());
  EXPECT_THAT(coordinator->MakeSummary().lost, testing::IsEmpty());
}

TEST_F(ResumedRunTest, NamesTheRobotsThatWereLostBeforeTheLastTick) {
  options.settings.ticks = 1;
  MakeAndStart(2);
  coordinator->OnAgentGone(2, now);
  Propose(1);
  ASSERT_TRUE(endpoint.frames.back().last);
  Resume();
  Wait(2.0 * options.lease_seconds + 0.1);
  Wait(1.1);
  EXPECT_EQ(coordinator->phase(), Phase::kOver);
  EXPECT_THAT(coordinator->MakeSummary().lost, testing::ElementsAre("r1"));
}

TEST_F(ResumedRunTest, OfTwoServicesOfARunTheEarlierOneStops) {
  MakeAndStart(1);
  SessionMessage other{.run = kRun, .host = "there", .incarnation = 1};
  coordinator->OnRivalService(other, now);
  EXPECT_THAT(coordinator->error().error().message,
              HasSubstr("another world service (there, pid 0) continues this run"));
  Propose(1);
  EXPECT_EQ(tick(), 0u);

  Resume();
  Rejoin(1);
  const std::size_t sessions = endpoint.sessions.size();
  other.incarnation = 0;
  coordinator->OnRivalService(other, now);
  EXPECT_TRUE(coordinator->error().ok());
  EXPECT_EQ(endpoint.sessions.size(), sessions + 1) << "the other one is informed";
}

}  // namespace
}  // namespace troupe
