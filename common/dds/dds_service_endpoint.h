// The world service's end of a DdsTransport.
#pragma once

#include <atomic>
#include <mutex>
#include <set>

#include "common/dds/dds_connection.h"
#include "common/dds/topic_types.h"
#include "common/protocol/transport.h"

namespace troupe::dds {

class DdsServiceEndpoint : public ServiceEndpoint {
 public:
  explicit DdsServiceEndpoint(const DdsConnection& connection);  // which must outlive it
  ~DdsServiceEndpoint() override;

  void Start(ServiceHandler& handler) override;
  void SendSession(const SessionMessage& session) override;
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override;
  void SendFrame(const FrameMessage& frame) override;
  void SendStatus(const StatusMessage& status) override;
  void SendControlReply(const ControlReply& reply) override;
  void Flush(double seconds) override;

 private:
  void DrainJoins();
  void DrainProposals();
  void DrainControls();
  void DrainSessions();

  Outbox<troupe_wire_Session> sessions_;
  Outbox<troupe_wire_Admissions> admissions_;
  Outbox<troupe_wire_Frame> frames_;
  Outbox<troupe_wire_Status> statuses_;
  Outbox<troupe_wire_ControlReply> control_replies_;
  Inbox<troupe_wire_Join, JoinMessage> joins_;
  Inbox<troupe_wire_Proposal, ProposalMessage> proposals_;
  Inbox<troupe_wire_Control, ControlRequest> controls_;
  Inbox<troupe_wire_Session, SessionMessage> rivals_;

  // Of the last frame.
  RunId sent_run_ = 0;
  Edition sent_edition_ = 0;
  WorldState sent_;

  std::mutex mutex_;  // held while a handler runs; guards what follows
  ServiceHandler* handler_ = nullptr;
  std::set<AgentId> agents_;  // that have sent a join and are not gone
};

}  // namespace troupe::dds
