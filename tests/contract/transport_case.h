// A transport to run the contract tests over.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "transport/protocol/transport.h"
#include "world-service/service/run_service.h"

namespace troupe::test {

// One session: the transports of its service and of each of its agents, as processes of their own would make them. The
// transports live as long as the rig.
class TransportRig {
 public:
  virtual ~TransportRig() = default;
  // Each call is for one more service of the same session.
  virtual Transport& ForService() = 0;
  // Each call is for one more agent process.
  virtual Transport& ForAgent() = 0;
  // Each call is for one more observer process.
  virtual Transport& ForObserver() = 0;
};

struct TransportCase {
  std::string name;
  std::function<std::unique_ptr<TransportRig>()> make;  // a session of its own
  bool loses = false;                                   // frames, so that observers must resend requests
  std::uint64_t ticks = 40;                             // length of the whole runs
};

inline void PrintTo(const TransportCase& transport, std::ostream* out) {
  *out << transport.name;
}

// Handlers that keep the messages delivered to them, and let a test wait for them.

// A list that one thread fills and another waits at.
template <typename T>
class Inbox {
 public:
  void Put(const T& item) {
    const std::lock_guard lock(mutex_);
    items_.push_back(item);
    changed_.notify_all();
  }
  std::vector<T> items() const {
    const std::lock_guard lock(mutex_);
    return items_;
  }
  // Waits for an item that `is_wanted`, at most `seconds`.
  template <typename Predicate>
  bool WaitFor(double seconds, const Predicate& is_wanted) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] {
      for (const T& item : items_) {
        if (is_wanted(item)) return true;
      }
      return false;
    });
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::vector<T> items_;
};

class CollectingService : public ServiceHandler {
 public:
  void OnJoin(const JoinMessage& join) override {
    joins.Put(join);
    if (on_join) on_join(join);
  }
  void OnProposal(const ProposalMessage& proposal) override {
    proposals.Put(proposal);
    if (on_proposal) on_proposal(proposal);
  }
  void OnAgentGone(AgentId agent) override { gone.Put(agent); }
  void OnRivalService(const SessionMessage& rival) override { rivals.Put(rival); }
  void OnControl(const ControlRequest& request) override { controls.Put(request); }

  std::function<void(const JoinMessage&)> on_join;  // both set before the start
  std::function<void(const ProposalMessage&)> on_proposal;
  Inbox<JoinMessage> joins;
  Inbox<ProposalMessage> proposals;
  Inbox<AgentId> gone;
  Inbox<SessionMessage> rivals;
  Inbox<ControlRequest> controls;
};

class CollectingAgent : public AgentHandler {
 public:
  void OnSession(const SessionMessage& session) override {
    sessions.Put(session);
    if (on_session) on_session(session);
  }
  void OnAdmission(const AdmissionMessage& admission) override { admissions.Put(admission); }
  void OnFrame(const FrameMessage& frame) override {
    frames.Put(frame);
    if (on_frame) on_frame(frame);
  }
  void OnHistory(const HistoryMessage& history) override { histories.Put(history); }
  void OnServiceGone() override { service_gone.Put(true); }
  void OnServiceLost() override { service_lost.Put(true); }

  std::function<void(const SessionMessage&)> on_session;  // both set before the start
  std::function<void(const FrameMessage&)> on_frame;
  Inbox<SessionMessage> sessions;
  Inbox<AdmissionMessage> admissions;
  Inbox<FrameMessage> frames;
  Inbox<HistoryMessage> histories;
  Inbox<bool> service_gone;
  Inbox<bool> service_lost;
};

// With their endpoints, which are started.
class StartedService final : public CollectingService {
 public:
  explicit StartedService(Transport& transport) : endpoint(transport.MakeServiceEndpoint()) { endpoint->Start(*this); }
  // With a transport of its own.
  explicit StartedService(std::unique_ptr<Transport> transport) : StartedService(*transport) {
    own_ = std::move(transport);
  }
  ~StartedService() override { endpoint.reset(); }

  std::unique_ptr<ServiceEndpoint> endpoint;

 private:
  std::unique_ptr<Transport> own_;
};

class StartedAgent final : public CollectingAgent {
 public:
  StartedAgent(Transport& transport, AgentId id) : endpoint(transport.MakeAgentEndpoint(id)) { endpoint->Start(*this); }
  StartedAgent(std::unique_ptr<Transport> transport, AgentId id) : StartedAgent(*transport, id) {
    own_ = std::move(transport);
  }
  ~StartedAgent() override { endpoint.reset(); }

  std::unique_ptr<AgentEndpoint> endpoint;

 private:
  std::unique_ptr<Transport> own_;
};

class CollectingObserver final : public ObserverHandler {
 public:
  void OnSession(const SessionMessage& session) override { sessions.Put(session); }
  void OnFrame(const SharedFrame& frame) override {
    frames.Put(*frame);
    if (on_frame) on_frame(*frame);
  }
  void OnStatus(const StatusMessage& status) override { statuses.Put(status); }
  void OnServiceGone() override { service_gone.Put(true); }

  std::function<void(const FrameMessage&)> on_frame;  // set before the start
  Inbox<SessionMessage> sessions;
  Inbox<FrameMessage> frames;
  Inbox<StatusMessage> statuses;
  Inbox<bool> service_gone;
};

// Whole runs over a transport: a world service and its agents, each in a thread of its own.

// Robots that drive among walls and into each other.
WorldDescription BusyWorld();

struct WholeRun {
  std::vector<std::vector<std::string>> agents;  // the robots of each, in the order in which the agents start
  bool service_first = true;                     // or last
  std::uint64_t ticks = 40;
  std::function<void()> before_agents = {};  // called when the service has started, if it is first
};

struct WholeRunResult {
  RunSummary summary;
  std::string hash_log;  // all of it
};

// Runs the busy world; failures are those of the test that calls.
WholeRunResult RunBusyWorld(TransportRig& rig, const WholeRun& run);

}  // namespace troupe::test
