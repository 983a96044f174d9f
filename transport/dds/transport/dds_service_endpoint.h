// The world service's end of a DdsTransport.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "transport/dds/convert/topic_types.h"
#include "transport/dds/transport/agent_group.h"
#include "transport/dds/transport/dds_connection.h"
#include "transport/dds/transport/frame_stream.h"
#include "transport/dds/transport/lost_agents.h"
#include "transport/protocol/transport.h"
#include "transport/shared_memory/service_segment.h"

namespace troupe::dds {

class DdsServiceEndpoint : public ServiceEndpoint {
 public:
  // A connection for each group of agents; the first is that of observers and tools, too. REQUIRES: there is one, and
  // they outlive it. `data_sharing`: with agents of this machine, through shared memory; the others are served over the
  // network.
  DdsServiceEndpoint(const std::vector<const DdsConnection*>& connections, bool data_sharing);
  ~DdsServiceEndpoint() override;

  void Start(ServiceHandler& handler) override;
  void SendSession(const SessionMessage& session) override;
  void ShareMap(std::span<const std::byte> bytes) override {
    if (segment_) segment_->ShareMap(bytes);
  }
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override;
  void SendFrame(const FrameMessage& frame) override;
  void SendHistory(const HistoryMessage& history) override;
  void SendStatus(const StatusMessage& status) override;
  void SendControlReply(const ControlReply& reply) override;
  void Flush(double seconds) override;

 private:
  // Calls a member below; the handler is told of a message for which there was no memory.
  void Deliver(const std::function<void()>& drain);
  void DrainJoins(AgentGroup& group);
  // Binds the agent to its first writer; false for any other one.
  bool Bind(AgentId agent, const Sender& sender);
  // Whether the sender's keys are for an agent of these robots.
  bool MayJoinFor(const std::vector<std::string>& robots, const Sender& sender);
  void Leave(AgentId agent, const Sender& sender);
  void LoseAgentsOf(const Sender& ended);
  // Whether the sender of a proposal is the agent that it names, or was until its lease expired.
  bool IsFromAgent(AgentGroup& group, AgentId agent, const Sender& sender);
  void DrainProposals(AgentGroup& group);
  void DrainControls();
  void DrainSessions();
  void DrainFrameRequests();
  // The thread of shared memory: delivers the proposals that arrive there.
  void CollectAnswers();
  void DrainAnswers();

  const DdsConnection& connection_;
  const std::unique_ptr<ServiceSegment> segment_;  // null: nothing is shared
  std::vector<std::unique_ptr<AgentGroup>> groups_;
  Outbox<troupe_wire_Frame> whole_frames_;  // to observers that have requested one
  Outbox<troupe_wire_Status> statuses_;
  Outbox<troupe_wire_ControlReply> control_replies_;
  Inbox<troupe_wire_Control, ControlRequest> controls_;
  Inbox<troupe_wire_FrameRequest, FrameRequest> frame_requests_;
  Inbox<troupe_wire_Session, SessionMessage> rivals_;

  std::atomic<RunId> run_ = 0;  // of the newest session; 0: none yet
  std::mutex frame_mutex_;      // guards the next member; locked after mutex_ where both are
  FrameStream stream_;

  std::mutex mutex_;  // locked while a handler runs; guards the members below it
  ServiceHandler* handler_ = nullptr;
  const bool secured_;
  const bool proven_;                                              // all senders whose samples pass are of the run
  std::map<std::string, std::set<std::string>> robots_of_agents_;  // by the names of the agents
  std::map<AgentId, Sender> agents_;  // that have sent a join and are alive: the writer of their joins
  std::map<dds_instance_handle_t, std::set<AgentId>> agents_of_writer_;  // the same, by the writer
  LostAgents lost_agents_;
  std::thread collector_;
};

}  // namespace troupe::dds
