// AgentGroup: the world service's endpoints for a group of its agents, on a participant of their own.
//
// Cyclone computes the addresses of a writer anew for each reader that matches, in time that grows with the square of
// the number of readers, and repeats discovery data and heartbeats to all of them while one is new. So the cost of a
// joining agent grows with its group, and a run on one machine divides hundreds of agents into groups.
#pragma once

#include <cstdint>
#include <string>

#include "transport/dds/convert/topic_types.h"
#include "transport/dds/transport/dds_connection.h"

namespace troupe::dds {

struct AgentGroup {
  // `sharing`: the address of the service's shared memory; empty: none. REQUIRES: the connection outlives it.
  AgentGroup(const DdsConnection& connection, const std::string& sharing);

  // Sends a frame to the readers of the network, if there are any: the changes since `base`, unless that is null or a
  // reader is new.
  void SendFrame(const FrameMessage& frame, const WorldState* base);
  // Waits until the agents have all messages; `remaining` gives the seconds that are left.
  template <typename Remaining>
  void Flush(const Remaining& remaining) {
    sessions.writer().wait_for_acknowledgments(remaining());
    admissions.writer().wait_for_acknowledgments(remaining());
    frames.writer().wait_for_acknowledgments(remaining());
  }

  Outbox<troupe_wire_Session> sessions;
  Outbox<troupe_wire_Admissions> admissions;
  Outbox<troupe_wire_Frame> frames;
  Outbox<troupe_wire_History> histories;
  Subscriber from_agents;
  Inbox<troupe_wire_Join, JoinMessage> joins;
  Inbox<troupe_wire_Proposal, ProposalMessage> proposals;

 private:
  std::uint32_t frame_readers_ = 0;  // on the network, when the newest frame was sent
};

}  // namespace troupe::dds
