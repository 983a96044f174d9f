// ScriptedService: the peer of an agent under test. The test chooses the messages of the service, and awaits those of
// the agent.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "common/base/identity.h"
#include "robot-agent/agent/agent_host.h"

namespace troupe {

class ScriptedService {
 public:
  explicit ScriptedService(WorldDescription world) : world_(std::move(world)) {}
  ~ScriptedService() {
    stop_.request_stop();
    if (thread_.joinable()) thread_.join();
  }

  // For the agent that is started next.
  void SetGateway(MakeGateway make_gateway) { make_gateway_ = std::move(make_gateway); }

  // Runs an agent on a thread of its own, and waits until it listens.
  void StartAgent(std::vector<std::string> robots = {}, const std::string& scan_log = "", double timeout = 30.0) {
    options_ = {.agent = 7,
                .robots = std::move(robots),
                .scan_log = scan_log,
                .libraries = AllowedPaths::All(),
                .session_timeout_seconds = timeout,
                .make_gateway = make_gateway_};
    thread_ = std::thread([this] {
      Result<AgentEnd> result = RunAgent(std::make_unique<Endpoint>(*this), options_, stop_.get_token());
      const std::lock_guard lock(mutex_);
      result_ = std::move(result);
      changed_.notify_all();
    });
    EXPECT_TRUE(Await([this] { return handler_ != nullptr || result_; }));
  }

  SessionMessage Session(RunId run = 1) const {
    return {.run = run,
            .protocol_version = kProtocolVersion,
            .host = "here",
            .pid = 1,
            .lease_seconds = 2.0,
            .world = world_};
  }
  FrameMessage Frame(Tick tick, RunId run = 1) const {
    FrameMessage frame{.run = run, .state = PlacedState(world_)};
    frame.state.tick = tick;
    return frame;
  }

  // Messages do nothing once the agent has ended.
  template <typename Message>
  void Send(void (AgentHandler::*receive)(const Message&), const Message& message) {
    Deliver([&](AgentHandler& handler) { (handler.*receive)(message); });
  }
  void SendSession(RunId run = 1) { Send(&AgentHandler::OnSession, Session(run)); }
  void SendFrame(Tick tick, RunId run = 1) { Send(&AgentHandler::OnFrame, Frame(tick, run)); }
  void SendLast(Tick tick) {
    FrameMessage frame = Frame(tick);
    frame.last = true;
    Send(&AgentHandler::OnFrame, frame);
  }
  void Admit(RunId run = 1, bool admitted = true, const std::string& reason = "") {
    Send(&AgentHandler::OnAdmission, AdmissionMessage{run, 7, admitted, reason});
  }
  void Leave() {
    Deliver([](AgentHandler& handler) { handler.OnServiceGone(); });
  }
  void Lose() {
    Deliver([](AgentHandler& handler) { handler.OnServiceLost(); });
  }
  void RunOutOfMemory() {
    Deliver([](AgentHandler& handler) { handler.OnOutOfMemory(); });
  }
  void Stop() { stop_.request_stop(); }

  // Awaits the n-th join, from 1 on.
  JoinMessage AwaitJoin(std::size_t n = 1) {
    EXPECT_TRUE(Await([&] { return joins_.size() >= n; })) << "no join came";
    const std::lock_guard lock(mutex_);
    return joins_.size() >= n ? joins_[n - 1] : JoinMessage{};
  }
  // Waits for a join of the given run.
  void AwaitJoinOf(RunId run) {
    EXPECT_TRUE(Await([&] { return !joins_.empty() && joins_.back().run == run; })) << "no join came";
  }
  // Session, join and admission.
  void StartAndAdmit(std::vector<std::string> robots = {}, const std::string& scan_log = "") {
    StartAgent(std::move(robots), scan_log);
    SendSession();
    AwaitJoin();
    Admit();
  }

  std::vector<ProposalMessage> proposals() {
    const std::lock_guard lock(mutex_);
    return proposals_;
  }
  // Awaits the n-th proposal, from 1 on.
  ProposalMessage AwaitProposal(std::size_t n) {
    EXPECT_TRUE(Await([&] { return proposals_.size() >= n; })) << "no proposal came";
    const std::lock_guard lock(mutex_);
    return proposals_.size() >= n ? proposals_[n - 1] : ProposalMessage{};
  }

  // Awaits the end of the agent.
  Result<AgentEnd> AwaitEnd() {
    EXPECT_TRUE(Await([this] { return result_.has_value(); })) << "the agent did not end";
    const std::lock_guard lock(mutex_);
    return result_ ? *result_ : Result<AgentEnd>(Error{{}, "did not end"});
  }
  std::string AwaitError() {
    const Result<AgentEnd> end = AwaitEnd();
    return end.ok() ? "" : end.error().ToString();
  }

 private:
  class Endpoint final : public AgentEndpoint {
   public:
    explicit Endpoint(ScriptedService& service) : service_(service) {}
    ~Endpoint() override { SetHandler(nullptr); }
    void Start(AgentHandler& handler) override { SetHandler(&handler); }
    void SendJoin(const JoinMessage& join) override { Add(service_.joins_, join); }
    void SendProposal(const ProposalMessage& proposal) override { Add(service_.proposals_, proposal); }

   private:
    void SetHandler(AgentHandler* handler) {
      // The test's thread may be inside a call; deliveries end before the endpoint does.
      const std::lock_guard delivery(service_.delivery_);
      const std::lock_guard lock(service_.mutex_);
      service_.handler_ = handler;
      service_.changed_.notify_all();
    }
    template <typename Message>
    void Add(std::vector<Message>& messages, const Message& message) {
      const std::lock_guard lock(service_.mutex_);
      messages.push_back(message);
      service_.changed_.notify_all();
    }
    ScriptedService& service_;
  };

  // Calls the handler, if the agent is there.
  template <typename Call>
  void Deliver(Call call) {
    const std::lock_guard delivery(delivery_);
    AgentHandler* handler = nullptr;
    {
      const std::lock_guard lock(mutex_);
      handler = handler_;
    }
    if (handler != nullptr) call(*handler);
  }

  template <typename Condition>
  bool Await(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(30), condition);
  }

  WorldDescription world_;
  MakeGateway make_gateway_;
  AgentOptions options_;
  std::stop_source stop_;
  std::mutex delivery_;  // held during calls of the handler
  std::mutex mutex_;
  std::condition_variable changed_;
  AgentHandler* handler_ = nullptr;
  std::vector<JoinMessage> joins_;
  std::vector<ProposalMessage> proposals_;
  std::optional<Result<AgentEnd>> result_;
  std::thread thread_;
};

}  // namespace troupe
