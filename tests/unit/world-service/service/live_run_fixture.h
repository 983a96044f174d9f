// LiveRunTest: a run without a coordinator, for tests of its parts. Only the test advances the time.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <memory>

#include "common/base/identity.h"
#include "tests/support/fake_service_endpoint.h"
#include "tests/unit/world-service/service/coordinator_fixture.h"
#include "transport/protocol/transport.h"
#include "world-service/service/live_run.h"
#include "world-service/service/tick_engine.h"

namespace troupe::test {

class LiveRunTest : public testing::Test {
 protected:
  static constexpr RunId kRun = 1000;

  // A plane with two robots; agent i + 1 is that of robot i.
  LiveRunTest() { options_.run = kRun; }

  // Makes the run and its engine.
  void Make() {
    const auto scene = std::make_shared<const Scene>(PlaneWorld(2));
    run_.reset(new LiveRun{.options = options_,
                           .endpoint = endpoint_,
                           .observers = observers_,
                           .created_at = now_,
                           .scene = scene,
                           .members = Membership(scene->world(), options_.lease_seconds)});
    engine_ = std::make_unique<TickEngine>(*run_, now_);
  }
  // Makes them, admits both agents and begins.
  void MakeAndBegin() {
    Make();
    for (AgentId agent = 1; agent <= 2; ++agent) Join(agent);
    engine_->Begin(now_);
  }

  void Join(AgentId agent) {
    JoinMessage join{.run = kRun,
                     .agent = agent,
                     .protocol_version = kProtocolVersion,
                     .world_hash = Hash(run_->world()),
                     .robots = {"r" + std::to_string(agent - 1)},
                     .world_edition = run_->frame.world_edition};
    const JoinDecision decision = run_->members.Join(join, run_->next_place(), now_);
    ASSERT_EQ(decision.outcome, JoinDecision::Outcome::kAdmitted) << decision.reason;
    engine_->AddMember(*decision.member, now_);
  }
  // The answer of an agent to the newest frame.
  ProposalMessage AnswerOf(AgentId agent) const {
    ProposalMessage message{kRun, agent, run_->next_tick(), {}, {}};
    message.paused = run_->frame.paused;
    message.edition = run_->frame.edition;
    if (!message.paused) message.proposals = {{RobotId(agent - 1), {1.0, 0.0, 0.0}}};
    return message;
  }
  void Answer(AgentId agent) { engine_->OnProposal(AnswerOf(agent), now_); }
  void AnswerBoth() {
    // Made first: the second answer may be followed by the next frame.
    const ProposalMessage answers[] = {AnswerOf(1), AnswerOf(2)};
    for (const ProposalMessage& answer : answers) engine_->OnProposal(answer, now_);
  }

  CoordinatorOptions options_;  // change before Make
  RunObservers observers_;      // likewise
  double now_ = 50.0;
  FakeServiceEndpoint endpoint_;
  std::unique_ptr<LiveRun> run_;
  std::unique_ptr<TickEngine> engine_;
};

// SteadyAgent: an agent of one robot that is only a handler of messages.
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
        {run_, robot_ + 1, kProtocolVersion, Hash(session.world), "here", 1, {session.world->robots[robot_].name}});
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

}  // namespace troupe::test
