// SteadyAgent: an agent of one robot that is only a handler of messages.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <memory>

#include "common/base/identity.h"
#include "transport/protocol/transport.h"

namespace troupe::test {

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

}  // namespace troupe::test
