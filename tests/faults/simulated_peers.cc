#include "tests/faults/simulated_peers.h"

#include <algorithm>
#include <utility>

namespace troupe::faults {
namespace {

constexpr double kMaxAgentWait = 0.1;  // s, as AgentHost
constexpr double kMaxTask = 0.05;      // s

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
  WakeAt(std::clamp(protocol_.NextPoll(), events_.now(), events_.now() + kMaxAgentWait));
}

void SimulatedAgent::BeginTask() {
  task_runs_ = true;
  const auto task = std::make_shared<ReplicaTask>(*protocol_.BeginTask());
  events_.After(network_.random().Uniform(0.0, kMaxTask), [this, task] {
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

SimulatedObserver::SimulatedObserver(EventQueue& events, Network& network, ProcessId id, Outputs outputs)
    : events_(events), network_(network), id_(id), outputs_(std::move(outputs)) {
  WakeLater();
}

void SimulatedObserver::OnSession(const SessionMessage& session) {
  run_ = session.run;
  protocol_.OnSession(session.run, session.world_edition);
  Act();
}

void SimulatedObserver::OnFrame(const troupe_wire_Frame& frame, bool requested) {
  const Status malformed = requested ? protocol_.OnWholeFrame(frame) : protocol_.OnFrame(frame);
  if (!malformed.ok()) outputs_.on_problem(malformed.error().message);
  Act();
  if (protocol_.has_gap() && protocol_.MayRequest(events_.now())) outputs_.send_request();
}

void SimulatedObserver::OnServiceGone() {
  if (run_) protocol_.OnEnd(*run_);
}

bool SimulatedObserver::HasShown(Edition edition, Tick tick) const {
  return shown_ && *shown_ >= std::pair(edition, tick);
}

void SimulatedObserver::Act() {
  const FrameMessage* frame = protocol_.Next();
  if (frame == nullptr) return;
  shown_.emplace(frame->edition, frame->state.tick);
  outputs_.on_frame(*frame);
}

void SimulatedObserver::WakeLater() {
  events_.After(dds::ObserverProtocol::kRequestPeriod, [this] {
    if (network_.HasEnded(id_)) return;
    network_.RunInside(id_, [this] {
      if (protocol_.IsBehind() && protocol_.MayRequest(events_.now())) outputs_.send_request();
      WakeLater();
    });
  });
}

}  // namespace troupe::faults
