#include "common/protocol/memory_transport.h"

#include <map>
#include <mutex>
#include <utility>

#include "common/protocol/delivery_thread.h"

namespace troupe {
namespace {

// Who receives what. Shared by the endpoints, which live no longer than the transport.
class Exchange {
 public:
  using Target = DeliveryThread::Target;

  Target AddService(ServiceHandler& handler);
  Target AddAgent(AgentHandler& handler);
  void RemoveService(Target service);
  void RemoveAgent(Target target, AgentId agent);

  void PublishSession(Target service, const SessionMessage& session);

  template <typename Message>
  void ToServices(void (ServiceHandler::*receive)(const Message&), const Message& message) {
    const auto shared = std::make_shared<const Message>(message);
    const std::lock_guard lock(mutex_);
    for (const auto& [target, handler] : services_) {
      delivery_.Post(target, [handler = handler, receive, shared] { (handler->*receive)(*shared); });
    }
  }
  template <typename Message>
  void ToAgents(void (AgentHandler::*receive)(const Message&), const Message& message) {
    const auto shared = std::make_shared<const Message>(message);
    const std::lock_guard lock(mutex_);
    for (const auto& [target, handler] : agents_) {
      delivery_.Post(target, [handler = handler, receive, shared] { (handler->*receive)(*shared); });
    }
  }

  void Flush(double seconds) { delivery_.WaitUntilIdle(seconds); }

 private:
  std::mutex mutex_;
  std::map<Target, ServiceHandler*> services_;
  std::map<Target, AgentHandler*> agents_;
  std::map<Target, std::shared_ptr<const SessionMessage>> sessions_;  // by the service that published it
  DeliveryThread delivery_;
};

Exchange::Target Exchange::AddService(ServiceHandler& handler) {
  const std::lock_guard lock(mutex_);
  const Target target = delivery_.AddTarget();
  services_[target] = &handler;
  for (const auto& [other, session] : sessions_) {
    delivery_.Post(target, [&handler, session = session] { handler.OnRivalService(*session); });
  }
  return target;
}

Exchange::Target Exchange::AddAgent(AgentHandler& handler) {
  const std::lock_guard lock(mutex_);
  const Target target = delivery_.AddTarget();
  agents_[target] = &handler;
  for (const auto& [service, session] : sessions_) {
    delivery_.Post(target, [&handler, session = session] { handler.OnSession(*session); });
  }
  return target;
}

void Exchange::RemoveService(Target service) {
  {
    const std::lock_guard lock(mutex_);
    services_.erase(service);
    sessions_.erase(service);
    for (const auto& [target, handler] : agents_) {
      delivery_.Post(target, [handler = handler] { handler->OnServiceGone(); });
    }
  }
  delivery_.RemoveTarget(service);
}

void Exchange::RemoveAgent(Target target, AgentId agent) {
  {
    const std::lock_guard lock(mutex_);
    agents_.erase(target);
    for (const auto& [service, handler] : services_) {
      delivery_.Post(service, [handler = handler, agent] { handler->OnAgentGone(agent); });
    }
  }
  delivery_.RemoveTarget(target);
}

void Exchange::PublishSession(Target service, const SessionMessage& session) {
  const auto shared = std::make_shared<const SessionMessage>(session);
  const std::lock_guard lock(mutex_);
  sessions_[service] = shared;
  for (const auto& [target, handler] : agents_) {
    delivery_.Post(target, [handler = handler, shared] { handler->OnSession(*shared); });
  }
  for (const auto& [target, handler] : services_) {
    if (target == service) continue;
    delivery_.Post(target, [handler = handler, shared] { handler->OnRivalService(*shared); });
  }
}

class MemoryServiceEndpoint final : public ServiceEndpoint {
 public:
  explicit MemoryServiceEndpoint(Exchange& exchange) : exchange_(exchange) {}
  ~MemoryServiceEndpoint() override {
    if (target_) exchange_.RemoveService(*target_);
  }
  void Start(ServiceHandler& handler) override { target_ = exchange_.AddService(handler); }
  void SendSession(const SessionMessage& session) override {
    TROUPE_CHECK(target_.has_value());
    exchange_.PublishSession(*target_, session);
  }
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override {
    for (const AdmissionMessage& admission : admissions) exchange_.ToAgents(&AgentHandler::OnAdmission, admission);
  }
  void SendFrame(const FrameMessage& frame) override { exchange_.ToAgents(&AgentHandler::OnFrame, frame); }
  void SendStatus(const StatusMessage&) override {}  // tools are other processes
  void Flush(double seconds) override { exchange_.Flush(seconds); }

 private:
  Exchange& exchange_;
  std::optional<Exchange::Target> target_;  // once started
};

class MemoryAgentEndpoint final : public AgentEndpoint {
 public:
  MemoryAgentEndpoint(Exchange& exchange, AgentId agent) : exchange_(exchange), agent_(agent) {}
  ~MemoryAgentEndpoint() override {
    if (target_) exchange_.RemoveAgent(*target_, agent_);
  }
  void Start(AgentHandler& handler) override { target_ = exchange_.AddAgent(handler); }
  void SendJoin(const JoinMessage& join) override { exchange_.ToServices(&ServiceHandler::OnJoin, join); }
  void SendProposal(const ProposalMessage& proposal) override {
    exchange_.ToServices(&ServiceHandler::OnProposal, proposal);
  }

 private:
  Exchange& exchange_;
  AgentId agent_;
  std::optional<Exchange::Target> target_;  // once started
};

class MemoryTransport final : public Transport {
 public:
  std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() override {
    return std::make_unique<MemoryServiceEndpoint>(exchange_);
  }
  std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId agent) override {
    return std::make_unique<MemoryAgentEndpoint>(exchange_, agent);
  }

 private:
  Exchange exchange_;
};

}  // namespace

std::unique_ptr<Transport> MakeMemoryTransport() {
  return std::make_unique<MemoryTransport>();
}

}  // namespace troupe
