// An agent's end of a DdsTransport. It answers on the thread that received the frame, without handing it over.
//
// Sessions, frames and proposals travel through the memory that a service of the same machine shares
// (transport/shared_memory). Their readers and their writer on the network exist only if a service was discovered that
// shares none.
//
// Ways to a service: it announces shared memory in the user data of its session writer. If this process can map it,
// sessions and frames are read by a thread that waits on a futex, and proposals are written into the agent's slot;
// else, or when sharing ends, the endpoints on the network are made. Which way is used changes times, no result.
//
// A reader of sessions exists in any case, which discovers services and their ends. With data sharing it asks for no
// earlier session: the world of a thousand robots, of which this process would read none, is megabytes.
//
// Only one participant is the service of a run for this agent (ServiceRegistry in senders.h); messages of others are
// ignored, and reported once.
//
// Locks: `mutex_` is held during every call of the handler, so that handlers run one at a time, whichever thread
// received; `ways_mutex_` is locked after it and guards the ways alone, so that a proposal can be sent from inside
// a handler.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/dds_connection.h"
#include "transport/dds/transport/senders.h"
#include "transport/protocol/transport.h"
#include "transport/shared_memory/agent_segment.h"

namespace troupe::dds {

class DdsAgentEndpoint : public AgentEndpoint {
 public:
  // REQUIRES: the connection outlives it. With `service`, only this participant is a world service.
  DdsAgentEndpoint(const DdsConnection& connection, const std::optional<GuidPrefix>& service, bool data_sharing);
  ~DdsAgentEndpoint() override;

  void Start(AgentHandler& handler) override;
  void SendJoin(const JoinMessage& join) override;
  void SendProposal(const ProposalMessage& proposal) override;
  std::optional<PreparedWorld> FindWorld(const WorldDescription& world) override;

 private:
  using Sessions = Inbox<troupe_wire_Session, SessionMessage>;
  // The readers of sessions and frames and the writer of proposals on the network.
  //
  // Threads: any, but for Close.
  class Network {
   public:
    using Frames = Inbox<troupe_wire_Frame, FrameMessage>;

    // `on_frames`, `on_sessions`: called when there may be some, on the thread that received them. Without
    // `on_sessions` there is no reader of them.
    Network(const DdsConnection& connection, std::function<void(Frames&)> on_frames,
            std::function<void(Sessions&)> on_sessions);
    ~Network() { Close(); }
    // Makes the endpoints. Throws Exception.
    void Make();
    // Calls on_frames and on_sessions from now on. REQUIRES: Make has succeeded.
    void Listen();
    // Makes them and listens, on a thread of its own: a listener must not make any. Repeats that after a failure, until
    // it succeeds or the network is closed.
    void Open();
    // Sends nothing while there are no endpoints.
    void Send(const ProposalMessage& proposal);
    // No call of these functions runs any more when it returns.
    void Close();

   private:
    struct Endpoints {
      Endpoints(const DdsConnection& connection, bool with_sessions);
      Outbox<troupe_wire_Proposal> proposals;
      Frames frames;
      std::optional<Sessions> sessions;
    };

    const DdsConnection& connection_;
    const std::function<void(Frames&)> on_frames_;
    const std::function<void(Sessions&)> on_sessions_;
    std::mutex mutex_;                      // guards the members below
    std::unique_ptr<Endpoints> endpoints_;  // once made, until the end
    std::thread maker_;
    bool closed_ = false;
    std::condition_variable closing_;
  };
  using Segment = std::shared_ptr<AgentSegment>;
  // How sessions and frames of a service come.
  struct Way {
    GuidPrefix service;
    Segment segment;  // null: over the network
  };
  struct Reader {
    std::weak_ptr<AgentSegment> segment;  // expires with the thread
    std::thread thread;
  };

  // Calls a member below; the handler gets a report of a message for which there was no memory.
  void Deliver(const std::function<void()>& drain);
  void DrainSessions();
  void DrainNetworkSessions(Sessions& sessions);
  void DrainAdmissions();
  void DrainFrames(Network::Frames& frames);
  void DrainHistories();
  // A service has ended, in order or not. REQUIRES: mutex_ is locked.
  void EndRuns(const GuidPrefix& service, bool in_order);
  // A session that came over the network: delivers it, or keeps it. REQUIRES: mutex_ is locked.
  void TakeSession(const SessionMessage& session, const Sender& sender);
  // A service has ended: delivers the session of one that may continue its run now. REQUIRES: mutex_ is locked.
  void FollowSuccessor();

  // Chooses the way to each service that was discovered. REQUIRES: mutex_ is locked.
  void SelectTransports();
  // A thread that has ended keeps its stack until it is joined. REQUIRES: mutex_ is locked.
  void JoinEndedReaders();
  // The service shares memory with this process. REQUIRES: mutex_ is locked.
  bool IsShared(const Sender& service);
  // Null: this service is to be reached over the network.
  Segment OpenSegment(const Sender& service);
  std::vector<Way> SharedWays();
  // The service shares memory with this process no more.
  void EndWay(const GuidPrefix& service);
  // The thread of a segment.
  void ReadFrames(const Way& way);
  // What has been published, and the end of sharing or of the run. REQUIRES: mutex_ is locked.
  void DrainSegment(const Way& way);
  // What has been published, to the handler. The result: what follows it. REQUIRES: mutex_ is locked.
  AgentSegment::Outcome ReadSegment(AgentSegment& segment, const GuidPrefix& service);
  // False: sessions and frames travel over the network from now on.
  bool ReadSharedSession(AgentSegment& segment, const GuidPrefix& service);

  const DdsConnection& connection_;
  const bool data_sharing_;
  Outbox<troupe_wire_Join> joins_;
  Sessions sessions_;
  Inbox<troupe_wire_Admissions, std::vector<AdmissionMessage>> admissions_;
  Inbox<troupe_wire_History, HistoryMessage> histories_;
  Network network_;

  // The run of the agent's last join; 0: none yet.
  std::atomic<RunId> joined_run_{0};
  std::mutex joined_mutex_;  // guards the next member
  std::set<AgentId> joined_agents_;

  std::mutex ways_mutex_;                      // guards the next member; locked after mutex_ where both are
  std::map<dds_instance_handle_t, Way> ways_;  // by the writers of services

  std::mutex mutex_;  // locked while a handler runs; guards the members below
  AgentHandler* handler_ = nullptr;
  ServiceRegistry services_;
  // Sessions of services that may continue a run once the run's service has ended. From the network: those in shared
  // memory wait there.
  std::map<GuidPrefix, SessionMessage> waiting_;
  std::vector<Reader> readers_;

  struct KnownWorld {
    std::weak_ptr<const Scene> scene;
    const WorldDescription* world;
    std::uint64_t hash;
  };
  std::mutex worlds_mutex_;         // guards the next member; no other is locked while it is
  std::vector<KnownWorld> worlds_;  // of sessions from shared memory
};

}  // namespace troupe::dds
