#include "tests/faults/simulated_observer.h"

#include <utility>

namespace troupe::faults {

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
