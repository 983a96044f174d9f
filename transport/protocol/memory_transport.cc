// MemoryTransport (transport.h): messages between endpoints of one process, for runs in one process and for tests.
//
// Every message is delivered, in order, by the one thread of a DeliveryThread; observers have queues of their own.
// Messages that several receivers get are shared and never change. Nothing is converted: a frame is copied once,
// whatever the number of agents.
//
// Locks: `mutex_` guards the lists of endpoints and the newest messages, and is not held during a delivery. An endpoint
// removes its target before it ends, which waits for a delivery that runs.
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <utility>

#include "transport/protocol/delivery.h"
#include "transport/protocol/transport.h"

namespace troupe {
namespace {

// For the ends of endpoints, which cannot fail. Without memory the others learn of the end later, or from the run.
template <typename Tell>
void TellUnlessOutOfMemory(const Tell& tell) {
  try {
    tell();
  } catch (const std::bad_alloc&) {
    return;
  }
}

// Delivers each message to the endpoints of its receivers. Shared by the endpoints, which live no longer than the
// transport.
class Exchange {
 public:
  using Target = DeliveryThread::Target;

  Target AddService(ServiceHandler& handler);
  Target AddAgent(AgentHandler& handler);
  void RemoveService(Target service);
  void RemoveAgent(Target target, AgentId agent);

  // The observer gets the sessions and the newest frame. REQUIRES: the queue lives until RemoveObserver.
  void AddObserver(ObserverQueue& observer);
  void RemoveObserver(ObserverQueue& observer);

  void PublishSession(Target service, const SessionMessage& session);
  void PublishFrame(const FrameMessage& frame);
  void PublishStatus(const StatusMessage& status);
  void SendNewestFrame(ObserverQueue& observer);

  template <typename Message>
  void ToServices(void (ServiceHandler::*receive)(const Message&), const Message& message) {
    const std::lock_guard lock(mutex_);
    for (const auto& [target, handler] : services_) {
      delivery_.Post(target, [handler = handler, receive, message] { (handler->*receive)(message); });
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
  std::set<ObserverQueue*> observers_;
  std::map<Target, std::shared_ptr<const SessionMessage>> sessions_;  // by the service that published it
  std::shared_ptr<const FrameMessage> newest_frame_;                  // null before the first
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
    // An observer that comes later must not get the frame of a run that is over.
    if (sessions_.empty()) newest_frame_.reset();
    TellUnlessOutOfMemory([this] {
      for (const auto& [target, handler] : agents_) {
        delivery_.Post(target, [handler = handler] { handler->OnServiceGone(); });
      }
      for (ObserverQueue* observer : observers_) {
        if (sessions_.empty()) observer->PostServiceGone();
      }
    });
  }
  delivery_.RemoveTarget(service);
}

void Exchange::RemoveAgent(Target target, AgentId agent) {
  {
    const std::lock_guard lock(mutex_);
    agents_.erase(target);
    TellUnlessOutOfMemory([this, agent] {
      for (const auto& [service, handler] : services_) {
        delivery_.Post(service, [handler = handler, agent] { handler->OnAgentGone(agent); });
      }
    });
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
  for (ObserverQueue* observer : observers_) observer->PostSession(shared);
}

void Exchange::AddObserver(ObserverQueue& observer) {
  const std::lock_guard lock(mutex_);
  observers_.insert(&observer);
  for (const auto& [service, session] : sessions_) observer.PostSession(session);
  if (newest_frame_ != nullptr) observer.PostFrame(newest_frame_);
}

void Exchange::RemoveObserver(ObserverQueue& observer) {
  const std::lock_guard lock(mutex_);
  observers_.erase(&observer);
}

void Exchange::PublishFrame(const FrameMessage& frame) {
  const auto shared = std::make_shared<const FrameMessage>(frame);
  const std::lock_guard lock(mutex_);
  for (const auto& [target, handler] : agents_) {
    delivery_.Post(target, [handler = handler, shared] { handler->OnFrame(*shared); });
  }
  for (ObserverQueue* observer : observers_) observer->PostFrame(shared);
  newest_frame_ = shared;
}

void Exchange::PublishStatus(const StatusMessage& status) {
  const std::lock_guard lock(mutex_);
  if (observers_.empty()) return;
  const auto shared = std::make_shared<const StatusMessage>(status);
  for (ObserverQueue* observer : observers_) observer->PostStatus(shared);
}

void Exchange::SendNewestFrame(ObserverQueue& observer) {
  const std::lock_guard lock(mutex_);
  if (newest_frame_ != nullptr) observer.PostFrame(newest_frame_);
}

class MemoryServiceEndpoint final : public ServiceEndpoint {
 public:
  explicit MemoryServiceEndpoint(Exchange& exchange) : exchange_(exchange) {}
  ~MemoryServiceEndpoint() override {
    if (target_) exchange_.RemoveService(*target_);
  }
  void Start(ServiceHandler& handler) override { target_ = exchange_.AddService(handler); }
  bool may_lose_messages() const override { return false; }
  void SendSession(const SessionMessage& session) override {
    TROUPE_CHECK(target_.has_value());
    exchange_.PublishSession(*target_, session);
  }
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override {
    for (const AdmissionMessage& admission : admissions) exchange_.ToAgents(&AgentHandler::OnAdmission, admission);
  }
  void SendFrame(const FrameMessage& frame) override { exchange_.PublishFrame(frame); }
  void SendHistory(const HistoryMessage& history) override { exchange_.ToAgents(&AgentHandler::OnHistory, history); }
  void SendStatus(const StatusMessage& status) override { exchange_.PublishStatus(status); }
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
    SendSharedProposal(std::make_shared<const ProposalMessage>(proposal));
  }
  void SendSharedProposal(const SharedProposal& proposal) override {
    exchange_.ToServices(&ServiceHandler::OnSharedProposal, proposal);
  }

 private:
  Exchange& exchange_;
  AgentId agent_;
  std::optional<Exchange::Target> target_;  // once started
};

class MemoryObserverEndpoint final : public ObserverEndpoint {
 public:
  explicit MemoryObserverEndpoint(Exchange& exchange) : exchange_(exchange) {}
  ~MemoryObserverEndpoint() override {
    if (!queue_) return;
    exchange_.RemoveObserver(*queue_);
    queue_->Close();  // while the handler may still call this endpoint
  }
  void Start(ObserverHandler& handler) override {
    TROUPE_CHECK(!queue_.has_value());
    exchange_.AddObserver(queue_.emplace(handler));
  }
  void RequestFrame() override {
    TROUPE_CHECK(queue_.has_value());
    exchange_.SendNewestFrame(*queue_);
  }

 private:
  Exchange& exchange_;
  std::optional<ObserverQueue> queue_;  // once started
};

class MemoryTransport final : public Transport {
 public:
  std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() override {
    return std::make_unique<MemoryServiceEndpoint>(exchange_);
  }
  std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId agent) override {
    return std::make_unique<MemoryAgentEndpoint>(exchange_, agent);
  }
  std::unique_ptr<ObserverEndpoint> MakeObserverEndpoint() override {
    return std::make_unique<MemoryObserverEndpoint>(exchange_);
  }

 private:
  Exchange exchange_;
};

}  // namespace

std::unique_ptr<Transport> MakeMemoryTransport() {
  return std::make_unique<MemoryTransport>();
}

}  // namespace troupe
