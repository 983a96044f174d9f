#include "transport/dds/transport/agent_group.h"

#include "transport/protocol/topics.h"

namespace troupe::dds {

AgentGroup::AgentGroup(const DdsConnection& connection, const std::string& sharing)
    : sessions(connection, topics::kSession, qos_profiles::Description(connection.lease_seconds), sharing),
      admissions(connection, topics::kAdmission, qos_profiles::Admission()),
      frames(connection, topics::kFrame, qos_profiles::Frame()),
      histories(connection, topics::kHistory, qos_profiles::PastStates()),
      from_agents(connection.participant, qos_profiles::AllAgents(connection.session)),
      joins(connection, from_agents, topics::kJoin, qos_profiles::FromMany(qos_profiles::Join())),
      proposals(connection, from_agents, topics::kProposal, qos_profiles::FromMany(qos_profiles::Proposal())) {}

void AgentGroup::SendFrame(const FrameMessage& frame, const WorldState* base) {
  const std::uint32_t readers = frames.CountReaders();
  // A new reader has no frame that this one could be the changes of.
  if (readers > 0) frames.Send(frame, readers > frame_readers_ ? nullptr : base);
  frame_readers_ = readers;
}

}  // namespace troupe::dds
