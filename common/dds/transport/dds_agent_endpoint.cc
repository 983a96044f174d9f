#include "common/dds/transport/dds_agent_endpoint.h"

#include <new>

#include "common/protocol/topics.h"

namespace troupe::dds {

DdsAgentEndpoint::DdsAgentEndpoint(const DdsConnection& connection, const std::optional<GuidPrefix>& service)
    : joins_(connection, topics::kJoin, qos_profiles::Join(connection.lease_seconds)),
      proposals_(connection, topics::kProposal, qos_profiles::Proposal()),
      sessions_(connection, topics::kSession, qos_profiles::FromMany(qos_profiles::Description())),
      admissions_(connection, topics::kAdmission, qos_profiles::Admission()),
      frames_(connection, topics::kFrame, qos_profiles::ReceivedFrame()),
      histories_(connection, topics::kHistory, qos_profiles::PastStates()),
      services_(connection.proves(), service) {}

DdsAgentEndpoint::~DdsAgentEndpoint() {
  sessions_.Close();
  admissions_.Close();
  frames_.Close();
  histories_.Close();
  // Without it the service may learn the end only when the lease expires: if this process ends before DDS has sent all.
  troupe_wire_Join last{};
  last.run = joined_run_;
  last.leaving = true;
  for (const AgentId agent : joined_agents_) {
    last.agent = agent;
    joins_.SendWire(last);
  }
}

void DdsAgentEndpoint::Start(AgentHandler& handler) {
  {
    const std::lock_guard lock(mutex_);
    TROUPE_CHECK(handler_ == nullptr);
    handler_ = &handler;
  }
  sessions_.Listen([this] { Deliver(&DdsAgentEndpoint::DrainSessions); });
  admissions_.Listen([this] { Deliver(&DdsAgentEndpoint::DrainAdmissions); });
  frames_.Listen([this] { Deliver(&DdsAgentEndpoint::DrainFrames); });
  histories_.Listen([this] { Deliver(&DdsAgentEndpoint::DrainHistories); });
  DrainSessions();
  DrainAdmissions();
  DrainFrames();
  DrainHistories();
}

void DdsAgentEndpoint::Deliver(void (DdsAgentEndpoint::*drain)()) {
  try {
    (this->*drain)();
  } catch (const std::bad_alloc&) {
    const std::lock_guard lock(mutex_);
    handler_->OnOutOfMemory();
  }
}

void DdsAgentEndpoint::DrainSessions() {
  const std::lock_guard lock(mutex_);
  sessions_.Drain(
      [this](const troupe_wire_Session& session, const Sender& sender) {
        if (!services_.Admits(sessions_, session.run, session.incarnation, sender)) return false;
        if (session.ended) EndRuns(sender, true);
        return !session.ended;
      },
      [this](const SessionMessage& session, const Sender&) { handler_->OnSession(session); },
      [this](const Sender& ended) { EndRuns(ended, false); });
  sessions_.Clear();  // a world may be large, and is received once
}

void DdsAgentEndpoint::EndRuns(const Sender& service, bool in_order) {
  for (const RunId run : services_.Forget(service.participant)) {
    // The late end of an earlier run of the session does not concern this agent.
    const RunId joined = joined_run_;
    if (run != joined && (joined != 0 || !services_.empty())) continue;
    if (in_order) {
      handler_->OnServiceGone();
    } else {
      handler_->OnServiceLost();
    }
  }
}

void DdsAgentEndpoint::DrainAdmissions() {
  const std::lock_guard lock(mutex_);
  admissions_.Drain(AdmitAll(), [this](const std::vector<AdmissionMessage>& admissions, const Sender& sender) {
    for (const AdmissionMessage& admission : admissions) {
      if (services_.Admits(admissions_, admission.run, admission.incarnation, sender)) handler_->OnAdmission(admission);
    }
  });
}

void DdsAgentEndpoint::DrainFrames() {
  const std::lock_guard lock(mutex_);
  frames_.Drain(
      [this](const troupe_wire_Frame& frame, const Sender& sender) {
        return services_.Admits(frames_, frame.run, frame.incarnation, sender);
      },
      [this](const FrameMessage& frame, const Sender&) { handler_->OnFrame(frame); });
}

void DdsAgentEndpoint::DrainHistories() {
  const std::lock_guard lock(mutex_);
  histories_.Drain(
      [this](const troupe_wire_History& history, const Sender& sender) {
        return services_.Admits(histories_, history.run, history.incarnation, sender);
      },
      [this](const HistoryMessage& history, const Sender&) { handler_->OnHistory(history); });
  histories_.Clear();  // large, and seldom
}

void DdsAgentEndpoint::SendJoin(const JoinMessage& join) {
  joined_run_ = join.run;
  {
    const std::lock_guard lock(joined_mutex_);
    joined_agents_.insert(join.agent);
  }
  joins_.Send(join);
}

void DdsAgentEndpoint::SendProposal(const ProposalMessage& proposal) {
  proposals_.Send(proposal);
}

}  // namespace troupe::dds
