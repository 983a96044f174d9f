// Transport: the connection between a world service, its agents and its observers. Implementations: transport.h
// (one process), transport/dds/transport/dds_transport.h (any number of processes and machines), faulty_transport.h
// (wraps another one and loses, delays, duplicates and reorders messages, for tests).
//
// Messages may be lost, late, duplicated or out of order in any of them; the tick protocol (docs/tick-protocol.md)
// tolerates that. The handler of an endpoint is called on one thread at a time, which the transport chooses; sending
// from inside a handler call is allowed. A handler must not destroy its endpoint.
//
// The seam between the tick protocol and its carrier: the run (world-service/service) and the agents
// (robot-agent/agent) know these interfaces alone, so that the same code runs in one process, over a network, or under
// faults. Three roles, each with a handler (the messages that it receives) and an endpoint (the messages that it
// sends).
//
// A handler is on the way of every tick: it must not wait for another process.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "transport/protocol/messages.h"

namespace troupe {

class Scene;

class ServiceHandler {
 public:
  virtual ~ServiceHandler() = default;
  virtual void OnJoin(const JoinMessage& join) = 0;
  virtual void OnProposal(const ProposalMessage& proposal) = 0;  // of an agent whose join was delivered before
  // The same, from a transport within a process: the handler may keep the message without a copy.
  virtual void OnSharedProposal(const SharedProposal& proposal) { OnProposal(*proposal); }
  // The agent has left.
  virtual void OnAgentGone(AgentId agent) = 0;
  // Its lease has expired: it has died, or was stopped for a time, or the network is cut. What it sends is delivered
  // all the same.
  virtual void OnAgentSilent(AgentId agent) { OnAgentGone(agent); }
  // Another service of the same session was discovered.
  virtual void OnRivalService(const SessionMessage& rival) = 0;
  // The request of a tool. SendControlReply answers it, now or later.
  virtual void OnControl(const ControlRequest& request) { (void)request; }
  // A message was lost for lack of memory, and so may be all that follow.
  virtual void OnOutOfMemory() {}
};

// The world service's end. It keeps the newest frame, and answers the frame requests of observers itself.
class ServiceEndpoint {
 public:
  virtual ~ServiceEndpoint() = default;  // no handler call runs any more when it returns
  // Starts delivering. REQUIRES: called once; the handler outlives the endpoint.
  virtual void Start(ServiceHandler& handler) = 0;
  // False if every message reaches its receivers, so that a late answer is no reason to send a frame again.
  virtual bool may_lose_messages() const { return true; }
  virtual void SendSession(const SessionMessage& session) = 0;  // kept for latecomers
  virtual void SendAdmissions(const std::vector<AdmissionMessage>& admissions) = 0;
  virtual void SendFrame(const FrameMessage& frame) = 0;
  virtual void SendHistory(const HistoryMessage& history) = 0;
  virtual void SendStatus(const StatusMessage& status) = 0;
  // No effect in transports without tools.
  virtual void SendControlReply(const ControlReply& reply) { (void)reply; }
  // Waits until the agents have received all messages that were sent, at most `seconds`; then as long until tools have
  // received their replies.
  virtual void Flush(double seconds) = 0;
};

class AgentHandler {
 public:
  virtual ~AgentHandler() = default;
  virtual void OnSession(const SessionMessage& session) = 0;
  virtual void OnAdmission(const AdmissionMessage& admission) = 0;  // of any agent
  virtual void OnFrame(const FrameMessage& frame) = 0;
  // The same, of a service on this machine that has checked that the state belongs to the world of the frame's edition.
  virtual void OnCheckedFrame(const FrameMessage& frame) { OnFrame(frame); }
  virtual void OnHistory(const HistoryMessage& history) { (void)history; }  // for any agent
  // The service has ended.
  virtual void OnServiceGone() = 0;
  // The lease of the service has expired: it has died, or it or this process was stopped for a time. In the latter case
  // the service continues, and its messages follow.
  virtual void OnServiceLost() { OnServiceGone(); }
  // A message was lost for lack of memory, and so may be all that follow.
  virtual void OnOutOfMemory() {}
};

// A world that another process has prepared for all agents of a machine.
struct PreparedWorld {
  std::shared_ptr<const Scene> scene;  // keeps its memory, and is valid: Validate found nothing
  std::uint64_t world_hash = 0;
};

// An agent's end.
class AgentEndpoint {
 public:
  virtual ~AgentEndpoint() = default;  // no handler call runs any more when it returns
  // Starts delivering. REQUIRES: called once; the handler outlives the endpoint.
  virtual void Start(AgentHandler& handler) = 0;
  virtual void SendJoin(const JoinMessage& join) = 0;
  virtual void SendProposal(const ProposalMessage& proposal) = 0;
  // The same, for a message that never changes: a transport within a process makes no copy.
  virtual void SendSharedProposal(const SharedProposal& proposal) { SendProposal(*proposal); }
  // The scene of the very description that a session of this endpoint brought, if its service shares it with the
  // machine; otherwise none. On any thread.
  virtual std::optional<PreparedWorld> FindWorld(const WorldDescription& world) {
    (void)world;
    return std::nullopt;
  }
};

// A tool that follows a run without influence on it: a viewer, a monitor.
// Shared, so that a handler keeps a state without a copy.
using SharedFrame = std::shared_ptr<const FrameMessage>;

class ObserverHandler {
 public:
  virtual ~ObserverHandler() = default;
  // The world of a run: before its first frame, and again after each edit that changed it.
  virtual void OnSession(const SessionMessage& session) = 0;
  // A committed tick with its whole state and its events. Frames may be missing or arrive twice. Its world is
  // that of the session message with the same run and world_edition; whether the state belongs to it (CheckState) was
  // not checked. `awaited` means nothing here.
  virtual void OnFrame(const SharedFrame& frame) = 0;
  virtual void OnStatus(const StatusMessage& status) = 0;
  // The service has ended, or its lease has expired. A later run of the session begins with OnSession.
  virtual void OnServiceGone() = 0;
};

// An observer's end. It joins a session at any time and receives its newest frame, then each following one. The handler
// has a thread of its own: a slow handler loses frames, and neither the service nor any agent or other observer waits
// for it.
class ObserverEndpoint {
 public:
  virtual ~ObserverEndpoint() = default;  // no handler call runs any more when it returns
  // Starts delivering. REQUIRES: called once; the handler outlives the endpoint.
  virtual void Start(ObserverHandler& handler) = 0;
  // Requests the newest frame from the service; OnFrame receives it even if it is known. The endpoint does so itself
  // when it joins and after a gap; a caller needs it only when its own queue has lost a frame. REQUIRES: started.
  virtual void RequestFrame() = 0;
};

class Transport {
 public:
  virtual ~Transport() = default;
  // The endpoints must not outlive the transport.
  virtual std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() = 0;
  virtual std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId agent) = 0;
  virtual std::unique_ptr<ObserverEndpoint> MakeObserverEndpoint() = 0;
};

// MemoryTransport: messages between endpoints of one process. One thread of its own delivers all messages, in the order
// of sending, so that a whole run needs no hand-over between threads. Makes the transport and starts its thread, which
// ends with it. A session message is kept for agents that start later.
std::unique_ptr<Transport> MakeMemoryTransport();

}  // namespace troupe
