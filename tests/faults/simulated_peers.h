// SimulatedAgent: an agent process on virtual time: an AgentProtocol with its replica, its timer and its tasks.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/agent/agent_protocol.h"
#include "tests/faults/network.h"
#include "transport/dds/transport/dds_observer_endpoint.h"

namespace troupe::faults {

class SimulatedAgent final : private AgentEndpoint {
 public:
  // What the agent sends; both are called inside its process.
  struct Outputs {
    std::function<void(const JoinMessage&)> send_join;
    std::function<void(const ProposalMessage&)> send_proposal;
    std::function<void(int exit_status)> on_end;  // by itself
  };

  SimulatedAgent(EventQueue& events, Network& network, const AgentOptions& options, Outputs outputs);

  ProcessId id() const { return options_.agent; }
  const std::vector<std::string>& robots() const { return options_.robots; }
  const AgentProtocol& protocol() const { return protocol_; }
  const JoinMessage* newest_join() const { return newest_join_.get(); }

  // Calls the protocol, and then acts as its driver. REQUIRES: inside the process.
  void Call(const std::function<void(AgentProtocol&)>& call);

 private:
  void Start(AgentHandler&) override {}
  void SendJoin(const JoinMessage&) override {}
  void SendProposal(const ProposalMessage& proposal) override { outputs_.send_proposal(proposal); }

  void Act();
  void BeginTask();
  void WakeAt(double time);

  EventQueue& events_;
  Network& network_;
  const AgentOptions options_;
  const Outputs outputs_;
  AgentProtocol protocol_;
  std::unique_ptr<JoinMessage> newest_join_;
  bool task_runs_ = false;
  bool ended_ = false;
  std::uint64_t wake_ = 0;  // the number of the newest wake-up; older ones do nothing
  double wake_at_ = -1.0;
};

// SimulatedObserver: an observer process on virtual time: an ObserverProtocol with its timer.
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
