// SimulatedObserver: an observer process on virtual time: an ObserverProtocol with its timer.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "tests/faults/network.h"
#include "transport/dds/transport/dds_observer_endpoint.h"

namespace troupe::faults {

class SimulatedObserver {
 public:
  struct Outputs {
    std::function<void()> send_request;                  // inside its process
    std::function<void(const FrameMessage&)> on_frame;   // each frame that the observer shows
    std::function<void(const std::string&)> on_problem;  // a message that is malformed
  };

  SimulatedObserver(EventQueue& events, Network& network, ProcessId id, Outputs outputs);

  // REQUIRES: inside the process, as all functions below.
  void OnSession(const SessionMessage& session);
  void OnFrame(const troupe_wire_Frame& frame, bool requested);
  void OnServiceGone();

  ProcessId id() const { return id_; }
  // The newest frame that it has shown.
  bool HasShown(Edition edition, Tick tick) const;

 private:
  void Act();
  void WakeLater();

  EventQueue& events_;
  Network& network_;
  const ProcessId id_;
  const Outputs outputs_;
  dds::ObserverProtocol protocol_;
  std::optional<RunId> run_;
  std::optional<std::pair<Edition, Tick>> shown_;
};

}  // namespace troupe::faults
