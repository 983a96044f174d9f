// An agent's end of a DdsTransport. It answers on the thread that received the frame, without handing it over.
#pragma once

#include <atomic>
#include <mutex>
#include <set>

#include "common/dds/convert/topic_types.h"
#include "common/dds/transport/dds_connection.h"
#include "common/dds/transport/known_services.h"
#include "common/protocol/transport.h"

namespace troupe::dds {

class DdsAgentEndpoint : public AgentEndpoint {
 public:
  // REQUIRES: the connection outlives it. With `service`, only this participant is a world service.
  DdsAgentEndpoint(const DdsConnection& connection, const std::optional<GuidPrefix>& service);
  ~DdsAgentEndpoint() override;

  void Start(AgentHandler& handler) override;
  void SendJoin(const JoinMessage& join) override;
  void SendProposal(const ProposalMessage& proposal) override;

 private:
  // Calls a member below; the handler is told of a message for which there was no memory.
  void Deliver(void (DdsAgentEndpoint::*drain)());
  void DrainSessions();
  void DrainAdmissions();
  void DrainFrames();
  void DrainHistories();
  void EndRuns(const Sender& service, bool in_order);

  Outbox<troupe_wire_Join> joins_;
  Outbox<troupe_wire_Proposal> proposals_;
  Inbox<troupe_wire_Session, SessionMessage> sessions_;
  Inbox<troupe_wire_Admissions, std::vector<AdmissionMessage>> admissions_;
  Inbox<troupe_wire_Frame, FrameMessage> frames_;
  Inbox<troupe_wire_History, HistoryMessage> histories_;

  // The run that the agent last asked to join; 0: none yet.
  std::atomic<RunId> joined_run_{0};
  std::mutex joined_mutex_;  // guards the next member
  std::set<AgentId> joined_agents_;
  std::mutex mutex_;  // locked while a handler runs; guards the members below
  AgentHandler* handler_ = nullptr;
  KnownServices services_;
};

}  // namespace troupe::dds
