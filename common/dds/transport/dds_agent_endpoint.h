// An agent's end of a DdsTransport. It answers on the thread that received the frame, without handing it over.
#pragma once

#include <atomic>
#include <mutex>
#include <set>

#include "common/dds/convert/topic_types.h"
#include "common/dds/transport/dds_connection.h"
#include "common/protocol/transport.h"

namespace troupe::dds {

class DdsAgentEndpoint : public AgentEndpoint {
 public:
  explicit DdsAgentEndpoint(const DdsConnection& connection);  // which must outlive it
  ~DdsAgentEndpoint() override;

  void Start(AgentHandler& handler) override;
  void SendJoin(const JoinMessage& join) override;
  void SendProposal(const ProposalMessage& proposal) override;

 private:
  void DrainSessions();
  void DrainAdmissions();
  void DrainFrames();

  Outbox<troupe_wire_Join> joins_;
  Outbox<troupe_wire_Proposal> proposals_;
  Inbox<troupe_wire_Session, SessionMessage> sessions_;
  Inbox<troupe_wire_Admissions, std::vector<AdmissionMessage>> admissions_;
  Inbox<troupe_wire_Frame, FrameMessage> frames_;

  // The run that the agent last asked to join; 0: none yet.
  std::atomic<RunId> joined_run_{0};
  std::mutex mutex_;  // locked while a handler runs; guards the members below
  AgentHandler* handler_ = nullptr;
  std::set<RunId> runs_;  // that have a live service
};

}  // namespace troupe::dds
