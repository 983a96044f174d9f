// The world service's end of a DdsTransport: frames to the network and to shared memory, joins and proposals from both,
// requests of tools, and the identity of every sender.
//
// AgentGroup has the endpoints for some of the agents, FrameStream decides which frames travel whole, LostAgents
// remembers agents whose lease has expired, and DdsServiceEndpoint connects them with the handler.
//
// Identity: an agent is bound to the writer of its first join, and its proposals are accepted from that writer's
// participant alone; with security, its name also has to be that in its keys. A message under another's name is
// refused, its sender reported once, and all that it sends on that topic ignored from then on. This is what keeps a
// faulty or hostile process from speaking for another robot.
//
// Locks: `mutex_` is held during every call of the handler, so that handlers run one at a time; `frame_mutex_` guards
// the stream of frames, and is locked after it, so that SendFrame may be called from a handler, or without one.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "transport/dds/binding/entity.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/dds_connection.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/transport.h"
#include "transport/shared_memory/service_segment.h"

namespace troupe::dds {

// AgentGroup: the world service's endpoints for a group of its agents, on a participant of their own.
//
// Cyclone computes the addresses of a writer again for each reader that matches, in time that grows with the square of
// the number of readers, and repeats discovery data and heartbeats to all of them while one is new. So the cost of a
// joining agent grows with its group, and a run on one machine divides hundreds of agents into groups.
struct AgentGroup {
  // `sharing`: the address of the service's shared memory; empty: none. REQUIRES: the connection outlives it.
  AgentGroup(const DdsConnection& connection_of_group, const std::string& sharing);

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

  const DdsConnection& connection;
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

// FrameStream: the frames of a service as they travel: most as the changes since the previous frame, some whole, and
// whole ones again for observers that have requested one. Without a clock: times are in s, of any clock that does not
// decrease. Not thread-safe.
class FrameStream {
 public:
  // The state that `frame` is to be sent as the changes of; null: it is to be sent whole. Valid until Sent.
  const WorldState* BaseOf(const FrameMessage& frame) const;
  void Sent(const FrameMessage& frame);

  // A request has arrived: the frame that is to be sent whole to the observers. Null if there is none, or it was sent
  // so recently that it will still arrive.
  const FrameMessage* AnswerRequest(double now);

 private:
  std::optional<FrameMessage> sent_;     // the newest
  std::optional<double> sent_whole_at_;  // to the observers; nothing: not yet
};

// LostAgents: the agents whose proposals are still accepted after their lease has expired, because the run asks them to
// join again. Of too many the oldest is forgotten.
class LostAgents {
 public:
  static constexpr std::size_t kMax = 1024;

  // Returns the agent that is forgotten for it, if any.
  std::optional<AgentId> Add(AgentId agent, const GuidPrefix& participant) {
    std::optional<AgentId> forgotten;
    if (agents_.size() == kMax && !agents_.contains(agent)) {
      const auto oldest = std::min_element(agents_.begin(), agents_.end(), [](const auto& a, const auto& b) {
        return a.second.number < b.second.number;
      });
      forgotten = oldest->first;
      agents_.erase(oldest);
    }
    agents_[agent] = {participant, next_number_++};
    return forgotten;
  }
  void Remove(AgentId agent) { agents_.erase(agent); }
  // Whether it was lost, and was of this participant.
  bool Contains(AgentId agent, const GuidPrefix& participant) const {
    const auto lost = agents_.find(agent);
    return lost != agents_.end() && lost->second.participant == participant;
  }

 private:
  struct Lost {
    GuidPrefix participant;
    std::uint64_t number = 0;  // in the order of the losses
  };

  std::map<AgentId, Lost> agents_;
  std::uint64_t next_number_ = 0;
};

class DdsServiceEndpoint : public ServiceEndpoint {
 public:
  // A connection for each group of agents; the first is that of observers and tools, too. REQUIRES: there is one, and
  // they outlive it. `data_sharing`: with agents of this machine, through shared memory; the others are served over the
  // network.
  DdsServiceEndpoint(const std::vector<const DdsConnection*>& connections, bool data_sharing);
  ~DdsServiceEndpoint() override;

  void Start(ServiceHandler& handler) override;
  // Publishes it in shared memory first: an agent of this host that finds it there needs no sample.
  void SendSession(const SessionMessage& session) override;
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override;
  void SendFrame(const FrameMessage& frame) override;
  void SendHistory(const HistoryMessage& history) override;
  void SendStatus(const StatusMessage& status) override;
  void SendControlReply(const ControlReply& reply) override;
  void Flush(double seconds) override;

 private:
  // Calls a member below; the handler gets a report of a message for which there was no memory.
  void Deliver(const std::function<void()>& drain);
  void DrainJoins(AgentGroup& group);
  // Binds the agent to the newest writer of its first participant; false for a writer of another participant, and for
  // one of too many agents.
  bool Bind(AgentId agent, const Sender& sender);
  // Whether the sender's keys are for an agent of the robots of the join.
  bool MayJoinFor(const troupe_wire_Join& join, const Sender& sender) const;
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
  const bool proven_;                 // all senders whose samples pass are of the run
  std::map<AgentId, Sender> agents_;  // that have sent a join and are alive: the writer of the last one
  std::map<dds_instance_handle_t, std::set<AgentId>> agents_of_writer_;  // the same, by the writer
  LostAgents lost_agents_;
  std::thread collector_;
};

}  // namespace troupe::dds
