// Transport: how messages travel between a world service and its agents. Implementations: memory_transport.h (one
// process), common/dds/dds_transport.h (any number of processes and machines), faulty_transport.h (wraps another one
// and loses, delays, doubles and reorders, for tests).
//
// Messages may be lost, late, doubled or out of order in any of them: the tick protocol (docs/tick-protocol.md) copes.
// Handlers are called one at a time for each endpoint, on a thread of the transport's choice; sending from inside a
// handler is allowed. Handlers must not destroy their endpoint.
#pragma once

#include <memory>
#include <vector>

#include "common/protocol/messages.h"

namespace troupe {

class ServiceHandler {
 public:
  virtual ~ServiceHandler() = default;
  virtual void OnJoin(const JoinMessage& join) = 0;
  virtual void OnProposal(const ProposalMessage& proposal) = 0;
  // The transport knows that the agent is gone (it left, or its lease ran out).
  virtual void OnAgentGone(AgentId agent) = 0;
  // Another service of the same session was seen.
  virtual void OnRivalService(const SessionMessage& rival) = 0;
  // A tool wants something. Its answer goes out by SendControlReply, now or later.
  virtual void OnControl(const ControlRequest& request) { (void)request; }
};

// The world service's end.
class ServiceEndpoint {
 public:
  virtual ~ServiceEndpoint() = default;  // no handler call runs any more when it returns
  // Starts delivering. REQUIRES: called once; the handler outlives the endpoint.
  virtual void Start(ServiceHandler& handler) = 0;
  virtual void SendSession(const SessionMessage& session) = 0;  // kept for latecomers
  virtual void SendAdmissions(const std::vector<AdmissionMessage>& admissions) = 0;
  virtual void SendFrame(const FrameMessage& frame) = 0;
  virtual void SendStatus(const StatusMessage& status) = 0;
  // Transports that no tool can reach have nobody to send it to.
  virtual void SendControlReply(const ControlReply& reply) { (void)reply; }
  // Waits until what was sent has been received by those who are there, at most `seconds`.
  virtual void Flush(double seconds) = 0;
};

class AgentHandler {
 public:
  virtual ~AgentHandler() = default;
  virtual void OnSession(const SessionMessage& session) = 0;
  virtual void OnAdmission(const AdmissionMessage& admission) = 0;  // of any agent
  virtual void OnFrame(const FrameMessage& frame) = 0;
  // The service is gone (it ended, or its lease ran out).
  virtual void OnServiceGone() = 0;
};

// An agent's end.
class AgentEndpoint {
 public:
  virtual ~AgentEndpoint() = default;  // no handler call runs any more when it returns
  // Starts delivering. REQUIRES: called once; the handler outlives the endpoint.
  virtual void Start(AgentHandler& handler) = 0;
  virtual void SendJoin(const JoinMessage& join) = 0;
  virtual void SendProposal(const ProposalMessage& proposal) = 0;
};

class Transport {
 public:
  virtual ~Transport() = default;
  // The endpoints must not outlive the transport.
  virtual std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() = 0;
  virtual std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId agent) = 0;
};

}  // namespace troupe
