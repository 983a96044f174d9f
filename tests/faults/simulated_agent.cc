#include "tests/faults/simulated_agent.h"

#include <algorithm>
#include <utility>

namespace troupe::faults {
namespace {

constexpr double kLongestAgentWait = 0.1;  // s, as AgentHost
constexpr double kLongestTask = 0.05;      // s

}  // namespace

SimulatedAgent::SimulatedAgent(EventQueue& events, Network& network, const AgentOptions& options, Outputs outputs)
    : events_(events),
      network_(network),
      options_(options),
      outputs_(std::move(outputs)),
      protocol_(*this, options_, {}, events.now()) {
  WakeAt(events_.now());
}

void SimulatedAgent::Call(const std::function<void(AgentProtocol&)>& call) {
  if (ended_) return;
  call(protocol_);
  Act();
}

void SimulatedAgent::Act() {
  protocol_.DrainNotices();
  if (protocol_.over()) {
    ended_ = true;
    const Status& failure = protocol_.failure();
    return outputs_.on_end(failure.ok() ? 0 : failure.error().code == ErrorCode::kBadInput ? 2 : 3);
  }
  if (task_runs_) return;
  if (protocol_.has_task()) return BeginTask();
  if (const std::optional<JoinMessage> join = protocol_.Poll(events_.now())) {
    newest_join_ = std::make_unique<JoinMessage>(*join);
    outputs_.send_join(*join);
  }
  if (protocol_.over()) return Act();
  WakeAt(std::clamp(protocol_.NextPoll(), events_.now(), events_.now() + kLongestAgentWait));
}

void SimulatedAgent::BeginTask() {
  task_runs_ = true;
  const auto task = std::make_shared<ReplicaTask>(*protocol_.BeginTask());
  events_.After(network_.random().Uniform(0.0, kLongestTask), [this, task] {
    network_.RunInside(id(), [this, task] {
      task->Perform(options_, {});
      task_runs_ = false;
      Call([&](AgentProtocol& protocol) { protocol.FinishTask(*task); });
    });
  });
}

void SimulatedAgent::WakeAt(double time) {
  if (wake_at_ >= events_.now() && wake_at_ <= time) return;
  wake_at_ = time;
  events_.At(time, [this, wake = ++wake_] {
    network_.RunInside(id(), [this, wake] {
      if (wake != wake_) return;
      wake_at_ = -1.0;
      Call([](AgentProtocol&) {});
    });
  });
}

}  // namespace troupe::faults
