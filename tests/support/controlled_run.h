// ControlledRun: a whole run in one process over the memory transport, paused from the start, for tests that step it
// and edit its world. Agents for new robots are started as the launcher does.
// The world service, its agents and the tool are the real ones; only the network is replaced by memory. A test steps
// the run and sees each frame before the next request, so that it needs no sleeps. Agents run on threads of their own,
// and all of them end in the destructor.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <future>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robot-agent/agent/agent_host.h"
#include "transport/protocol/faulty_transport.h"
#include "transport/protocol/transport.h"
#include "world-service/observers/recorder/recorder.h"
#include "world-service/replay/journal_history.h"
#include "world-service/service/run_service.h"

namespace troupe::test {

class ControlledRun final : private RunObserver {
 public:
  struct Setup {
    std::size_t packing = 1;  // robots of an agent
    Faults faults = {};
    double start_timeout_seconds = 60.0;
    bool start_new_agents = true;
    OutputFiles outputs = {};
    std::string world_file = {};
    OnAgentLoss on_agent_loss = OnAgentLoss::kFreeze;
    Speed speed = {};
    bool can_rewind = false;
    // A history in place of that of the recording, which it may use; `stop` stops the run. Outlives the run.
    std::function<RunHistory*(RunHistory* history, std::atomic<bool>& stop)> wrap_history = {};
  };

  ControlledRun(WorldDescription world, const Setup& setup)
      : setup_(setup), scene_(std::make_shared<const Scene>(std::move(world))) {
    transport_ = MakeMemoryTransport();
    if (setup.faults.any()) transport_ = MakeFaultyTransport(std::move(transport_), setup.faults);
    std::vector<std::string> names;
    for (const RobotDescription& robot : scene_->world().robots) names.push_back(robot.name);
    StartAgents(names);
    ServiceOptions options{
        .start_timeout_seconds = setup.start_timeout_seconds, .start_paused = true, .world_file = setup.world_file};
    options.settings.agent_deadline_seconds = 0.0;
    options.settings.on_agent_loss = setup.on_agent_loss;
    options.settings.speed = setup.speed;
    const bool needs_memory = setup.can_rewind || setup.on_agent_loss == OnAgentLoss::kRebuild;
    recorders_ = MakeRecorders(scene_->world(), setup.outputs, setup.world_file, needs_memory).value();
    RunObservers observers = {this};
    for (const auto& recorder : recorders_.observers) observers.push_back(recorder.get());
    history_ = MakeRunHistory(recorders_.recordings);
    options.history = setup.wrap_history ? setup.wrap_history(history_.get(), stop_) : history_.get();
    service_ = std::thread([this, options, observers] {
      summary_ = RunService(scene_, options, transport_->MakeServiceEndpoint(), observers, stop_);
      StopAgents();  // those that have not ended
    });
  }
  ~ControlledRun() override { static_cast<void>(Finish()); }

  // Sends a request and waits for its reply.
  ControlReply Ask(control::Request request) {
    WorldControl* const control = Control();
    auto answered = std::make_shared<std::promise<ControlReply>>();
    std::future<ControlReply> reply = answered->get_future();
    if (control == nullptr) return {};
    control->Request(request, [answered](const ControlReply& content) { answered->set_value(content); });
    if (reply.wait_for(std::chrono::seconds(60)) != std::future_status::ready) {
      ADD_FAILURE() << "no answer arrived";
      return {};
    }
    return reply.get();
  }
  // REQUIRES: the run is paused.
  void Step(std::uint64_t ticks) {
    const ControlReply reply = Ask(control::Step{.ticks = ticks});
    EXPECT_TRUE(reply.done) << reply.problem;
  }

  // The frames so far, without resent ones.
  std::vector<FrameMessage> frames() {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  // The state hashes from frame `begin` on.
  std::vector<std::uint64_t> Hashes(std::size_t begin = 0) {
    std::vector<std::uint64_t> hashes;
    for (const FrameMessage& frame : frames()) hashes.push_back(frame.state_hash);
    hashes.erase(hashes.begin(), hashes.begin() + static_cast<std::ptrdiff_t>(std::min(begin, hashes.size())));
    return hashes;
  }
  FrameMessage frame() { return frames().back(); }
  std::vector<std::string> notices() {
    const std::lock_guard lock(mutex_);
    return notices_;
  }

  // Ends the run and returns its result.
  Result<RunSummary> Finish() {
    stop_ = true;
    if (service_.joinable()) service_.join();
    std::list<Agent> agents;
    {
      const std::lock_guard lock(mutex_);
      agents.swap(agents_);
    }
    for (Agent& agent : agents) agent.thread.join();
    return summary_;
  }
  // Ends the newest agent of a robot, and starts another one for the same robots, which knows nothing.
  void ReplaceAgentOf(const std::string& robot) {
    std::vector<std::string> robots;
    std::list<Agent> old;
    {
      const std::lock_guard lock(mutex_);
      const auto has_robot = [&](const Agent& agent) {
        return std::find(agent.robots.begin(), agent.robots.end(), robot) != agent.robots.end();
      };
      const auto found = std::find_if(agents_.begin(), agents_.end(), has_robot);
      ASSERT_NE(found, agents_.end()) << "no agent runs for " << robot;
      robots = found->robots;
      old.splice(old.end(), agents_, found);
    }
    old.front().stop.request_stop();
    old.front().thread.join();
    StartAgent(robots);
  }
  // The end of the agent of a robot. REQUIRES: the agent ends.
  Result<AgentEnd> AwaitAgentOf(const std::string& robot) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(60), [&] { return ended_.contains(robot); }));
    return ended_.contains(robot) ? ended_.at(robot) : Result<AgentEnd>(Error{{}, "did not end"});
  }

 private:
  struct Agent {
    std::vector<std::string> robots;
    std::stop_source stop;
    std::thread thread;
  };

  WorldControl* Control() {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(60), [this] { return control_ != nullptr && started_; }));
    return control_;
  }

  void StartAgents(const std::vector<std::string>& robots) {
    for (std::size_t i = 0; i < robots.size(); i += setup_.packing) {
      const auto begin = robots.begin() + static_cast<std::ptrdiff_t>(i);
      StartAgent({begin, begin + static_cast<std::ptrdiff_t>(std::min(setup_.packing, robots.size() - i))});
    }
  }
  void StartAgent(const std::vector<std::string>& robots) {
    const std::lock_guard lock(mutex_);
    AgentOptions options{.agent = ++last_agent_, .robots = robots, .libraries = AllowedPaths::All()};
    Agent& agent = agents_.emplace_back();
    agent.robots = robots;
    if (agents_stop_) agent.stop.request_stop();
    agent.thread = std::thread([this, options, &agent] {
      Result<AgentEnd> end = RunAgent(transport_->MakeAgentEndpoint(options.agent), options, agent.stop.get_token());
      const std::lock_guard agent_lock(mutex_);
      for (const std::string& robot : options.robots) ended_.insert_or_assign(robot, end);
      changed_.notify_all();
    });
  }
  void StopAgents() {
    const std::lock_guard lock(mutex_);
    agents_stop_ = true;
    for (Agent& agent : agents_) agent.stop.request_stop();
  }

  Status OnBegin(const RunStart& start) override {
    const std::lock_guard lock(mutex_);
    control_ = &start.control;
    changed_.notify_all();
    return Status();
  }
  Status OnEnd() override {
    const std::lock_guard lock(mutex_);
    control_ = nullptr;
    return Status();
  }
  Status OnTick(const CommittedTick& tick) override {
    const std::lock_guard lock(mutex_);
    frames_.push_back(tick.frame);
    return Status();
  }
  void OnStarted(double) override {
    const std::lock_guard lock(mutex_);
    started_ = true;
    changed_.notify_all();
  }
  void OnNotice(const std::string& text) override {
    const std::lock_guard lock(mutex_);
    notices_.push_back(text);
  }
  void OnNewRobots(const std::vector<std::string>& robots, Edition) override {
    if (setup_.start_new_agents) StartAgents(robots);
  }

  const Setup setup_;
  const std::shared_ptr<const Scene> scene_;
  std::unique_ptr<Transport> transport_;
  Recorders recorders_;
  std::unique_ptr<RunHistory> history_;
  std::atomic<bool> stop_ = false;
  Result<RunSummary> summary_ = Error{{}, "the run did not end"};
  std::mutex mutex_;
  std::condition_variable changed_;
  WorldControl* control_ = nullptr;
  bool started_ = false;
  std::vector<FrameMessage> frames_;
  std::vector<std::string> notices_;
  AgentId last_agent_ = 0;
  bool agents_stop_ = false;  // also those to be started
  std::list<Agent> agents_;
  std::map<std::string, Result<AgentEnd>> ended_;  // by robot
  std::thread service_;
};

}  // namespace troupe::test
