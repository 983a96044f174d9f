#include "common/dds/transport/dds_agent_endpoint.h"

#include "common/dds/transport/topics.h"

namespace troupe::dds {

DdsAgentEndpoint::DdsAgentEndpoint(const DdsConnection& connection)
    : joins_(connection, topics::kJoin, qos_profiles::Join(connection.lease_seconds)),
      proposals_(connection, topics::kProposal, qos_profiles::Proposal()),
      sessions_(connection, topics::kSession, qos_profiles::Description()),
      admissions_(connection, topics::kAdmission, qos_profiles::Admission()),
      frames_(connection, topics::kFrame, qos_profiles::Frame()) {}

DdsAgentEndpoint::~DdsAgentEndpoint() {
  sessions_.Close();
  admissions_.Close();
  frames_.Close();
}

void DdsAgentEndpoint::Start(AgentHandler& handler) {
  {
    const std::lock_guard lock(mutex_);
    TROUPE_CHECK(handler_ == nullptr);
    handler_ = &handler;
  }
  sessions_.Listen([this] { DrainSessions(); });
  admissions_.Listen([this] { DrainAdmissions(); });
  frames_.Listen([this] { DrainFrames(); });
  DrainSessions();
  DrainAdmissions();
  DrainFrames();
}

void DdsAgentEndpoint::DrainSessions() {
  const std::lock_guard lock(mutex_);
  sessions_.Drain(
      [this](const SessionMessage& session) {
        runs_.insert(session.run);
        handler_->OnSession(session);
      },
      [this](const troupe_wire_Session& ended) {
        if (runs_.erase(ended.run) == 0) return;
        // The late end of an earlier run of the session does not concern this agent.
        const RunId joined = joined_run_;
        if (ended.run == joined || (joined == 0 && runs_.empty())) handler_->OnServiceGone();
      });
  sessions_.Clear();  // a world may be large, and is received once
}

void DdsAgentEndpoint::DrainAdmissions() {
  const std::lock_guard lock(mutex_);
  admissions_.Drain([this](const std::vector<AdmissionMessage>& admissions) {
    for (const AdmissionMessage& admission : admissions) handler_->OnAdmission(admission);
  });
}

void DdsAgentEndpoint::DrainFrames() {
  const std::lock_guard lock(mutex_);
  frames_.Drain([this](const FrameMessage& frame) { handler_->OnFrame(frame); });
}

void DdsAgentEndpoint::SendJoin(const JoinMessage& join) {
  joined_run_ = join.run;
  joins_.Send(join);
}

void DdsAgentEndpoint::SendProposal(const ProposalMessage& proposal) {
  proposals_.Send(proposal);
}

}  // namespace troupe::dds
