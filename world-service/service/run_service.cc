#include "world-service/service/run_service.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "world-service/service/event_text.h"
#include "world-service/service/requested_file.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;
using Phase = TickCoordinator::Phase;

// Wall times, s.
constexpr double kStatusPeriod = 0.5;
constexpr double kLongestWait = 0.05;  // so that `stop`, and what there is to tell, need not wait for longer
constexpr double kFlushTime = 0.5;

constexpr std::size_t kMostFileRequests = 100;  // a hostile tool may send any number

double Now() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

Clock::time_point TimePoint(double seconds) {
  return Clock::time_point(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
}

RunId MakeRunId() {
  std::random_device device;
  return (static_cast<RunId>(device()) << 32) | device();
}

std::string HostName() {
  char name[256] = "";
  if (gethostname(name, sizeof name - 1) != 0 || name[0] == '\0') return "localhost";
  return name;
}

// Brings the transport's threads and the one that waits for time to pass together at one coordinator.
class Driver final : public WorldControl, private ServiceHandler {
 public:
  Driver(const Scene& scene, const ServiceOptions& service, const CoordinatorOptions& options,
         std::unique_ptr<ServiceEndpoint> endpoint, Recorder& recorder, WorldGateway* gateway, TickTrace* trace,
         RunObserver& observer)
      : service_(service),
        observer_(observer),
        trace_(trace),
        coordinator_(scene, options, *endpoint, recorder, Now(), gateway),
        endpoint_(std::move(endpoint)) {}

  void Start() {
    endpoint_->Start(*this);
    Handle([&](double) { coordinator_.Announce(); });
  }

  // Until the run is over.
  void Run(const std::atomic<bool>& stop) {
    std::unique_lock lock(mutex_);
    double next_status = Now() + kStatusPeriod;
    while (coordinator_.phase() != Phase::kOver) {
      const double now = Now();
      Act([&] {
        if (stop) coordinator_.Stop(now);
        coordinator_.Poll(now);
      });
      if (trace_ != nullptr) trace_->WriteSome();
      const bool status_due = now >= next_status;
      if (status_due) next_status = now + kStatusPeriod;
      if (AgentsHaveCome()) TellWhoHasCome(lock);
      Tell(status_due, lock);
      ReadFiles(lock);

      wake_at_ = std::clamp(coordinator_.NextPoll(), now, now + kLongestWait);
      if (file_requests_.empty()) wake_.wait_until(lock, TimePoint(wake_at_));
    }
    Tell(true, lock);
    Act([&] {
      for (const AskedRequest& open : std::exchange(file_requests_, {})) {
        coordinator_.Refuse(open.request, open.reply, "the run is over");
      }
    });
  }

  void Request(const ControlRequest& request, ControlReplyTo reply) override {
    if (acting_ == std::this_thread::get_id()) {
      asked_meanwhile_.push_back({request, std::move(reply)});  // by who got an answer: the lock is this thread's
      return;
    }
    Handle([&](double) { Take({request, std::move(reply)}); });
  }

  // REQUIRES: Run has returned.
  Result<RunSummary> Finish() {
    endpoint_->Flush(kFlushTime);
    const std::lock_guard lock(mutex_);
    if (coordinator_.error()) return *coordinator_.error();
    return coordinator_.MakeSummary();
  }

 private:
  struct AskedRequest {
    ControlRequest request;
    ControlReplyTo reply;
  };

  // Calls something of the coordinator's, and then takes what was asked for from inside its answers. With the lock.
  template <typename Call>
  void Act(const Call& call) {
    acting_ = std::this_thread::get_id();
    call();
    while (!asked_meanwhile_.empty()) {
      AskedRequest next = std::move(asked_meanwhile_.front());
      asked_meanwhile_.pop_front();
      Take(std::move(next));
    }
    acting_ = std::thread::id();
  }

  void Take(AskedRequest asked) {
    if (!NeedsFiles(asked.request.command)) {
      return coordinator_.Control(asked.request, std::move(asked.reply), Now());
    }
    // Files take time, so Run reads them: no message may wait for it.
    if (coordinator_.phase() == Phase::kOver) {
      return coordinator_.Refuse(asked.request, asked.reply, "the run is over");
    }
    if (file_requests_.size() >= kMostFileRequests) {
      return coordinator_.Refuse(asked.request, asked.reply, "too many requests are waiting");
    }
    file_requests_.push_back(std::move(asked));
  }

  static bool NeedsFiles(ControlCommand command) {
    return command == ControlCommand::kLoadWorld || command == ControlCommand::kSpawn ||
           command == ControlCommand::kSpawnables;
  }

  void ReadFiles(std::unique_lock<std::mutex>& lock) {
    while (!file_requests_.empty()) {
      const AskedRequest open = std::move(file_requests_.front());
      file_requests_.pop_front();
      lock.unlock();
      const RequestedFile file = ReadRequestedFile(service_, open.request);
      lock.lock();
      Act([&] { Finish(open, file); });
    }
  }

  void Finish(const AskedRequest& open, const RequestedFile& file) {
    if (!file.problem.empty()) return coordinator_.Refuse(open.request, open.reply, file.problem);
    if (open.request.command == ControlCommand::kSpawnables) {
      return coordinator_.Reply(open.request, open.reply, file.spawnables);
    }
    const bool loads = open.request.command == ControlCommand::kLoadWorld;
    if (loads && coordinator_.phase() == Phase::kRunning) service_.world_file = open.request.source;
    coordinator_.Control(open.request, open.reply, Now(), file.world);
  }

  void OnJoin(const JoinMessage& join) override {
    Handle([&](double now) { coordinator_.OnJoin(join, now); });
  }
  void OnProposal(const ProposalMessage& proposal) override {
    Handle([&](double now) { coordinator_.OnProposal(proposal, now); });
  }
  void OnAgentGone(AgentId agent) override {
    Handle([&](double now) { coordinator_.OnAgentGone(agent, now); });
  }
  void OnRivalService(const SessionMessage& rival) override {
    Handle([&](double now) { coordinator_.OnRivalService(rival, now); });
  }

  void OnControl(const ControlRequest& request) override {
    Request(request, [this](const ControlReply& reply) { endpoint_->SendControlReply(reply); });
  }

  template <typename Call>
  void Handle(const Call& call) {
    bool wake = false;
    {
      const std::lock_guard lock(mutex_);
      Act([&] { call(Now()); });
      wake = coordinator_.NextPoll() < wake_at_ || !file_requests_.empty() || AgentsHaveCome();
    }
    if (wake) wake_.notify_one();
  }

  // Before the run begins, somebody may wait for agents to come before starting more.
  bool AgentsHaveCome() const {
    return coordinator_.phase() == Phase::kGathering && coordinator_.present_agents() != told_agents_;
  }
  void TellWhoHasCome(std::unique_lock<std::mutex>& lock) {
    told_agents_ = coordinator_.present_agents();
    const StatusMessage status = coordinator_.MakeStatus(Now());
    lock.unlock();
    observer_.OnStatus(status);
    lock.lock();
  }

  // Tells the observer what is new. The lock is open meanwhile: ticks do not wait for an observer.
  void Tell(bool with_status, std::unique_lock<std::mutex>& lock) {
    const std::vector<std::string> notices = coordinator_.TakeNotices();
    const std::vector<Event> events = coordinator_.TakeEvents();
    const std::vector<std::string> new_robots = coordinator_.TakeNewRobots();
    const std::shared_ptr<const Scene> scene = coordinator_.scene();  // that the events are of
    const std::optional<double> startup = started_ ? std::nullopt : coordinator_.startup_seconds();
    std::optional<StatusMessage> status;
    if (with_status) status = coordinator_.MakeStatus(Now());
    if (startup) started_ = true;

    lock.unlock();
    for (const std::string& notice : notices) observer_.OnNotice(notice);
    if (startup) observer_.OnStarted(*startup);
    if (!new_robots.empty()) observer_.OnNewRobots(new_robots);
    for (const Event& event : events) observer_.OnEvent(event, EventText(scene->world(), event));
    if (status) {
      endpoint_->SendStatus(*status);
      observer_.OnStatus(*status);
    }
    lock.lock();
  }

  ServiceOptions service_;
  RunObserver& observer_;
  TickTrace* const trace_;  // null: none
  bool started_ = false;    // the observer knows
  std::mutex mutex_;        // for what follows
  std::condition_variable wake_;
  std::size_t told_agents_ = 0;  // who had come when the observer was told
  double wake_at_ = 0.0;         // when Run wakes up by itself
  std::deque<AskedRequest> file_requests_;
  std::deque<AskedRequest> asked_meanwhile_;
  std::atomic<std::thread::id> acting_ = std::thread::id();  // the thread that is inside the coordinator
  TickCoordinator coordinator_;
  std::unique_ptr<ServiceEndpoint> endpoint_;  // last, so that it is gone before what its deliveries use
};

}  // namespace

Result<RunSummary> RunService(const Scene& scene, const ServiceOptions& options,
                              std::unique_ptr<ServiceEndpoint> endpoint, RunObserver& observer,
                              const std::atomic<bool>& stop) {
  Result<Recorder> recorder = Recorder::Create(scene.world(), options.outputs);
  if (!recorder.ok()) return recorder.error();

  std::unique_ptr<TickTrace> trace;
  if (!options.trace.file.empty()) {
    Result<std::unique_ptr<TickTrace>> created = TickTrace::Create(options.trace, "world-service");
    if (!created.ok()) return created.error();
    trace = std::move(created).value();
  }

  CoordinatorOptions coordinator;
  coordinator.settings = options.settings;
  coordinator.run = MakeRunId();
  coordinator.lease_seconds = options.lease_seconds;
  coordinator.start_timeout_seconds = options.start_timeout_seconds;
  coordinator.start_paused = options.start_paused;
  if (trace) coordinator.trace = trace->AddLane();
  coordinator.host = HostName();
  coordinator.pid = static_cast<std::uint32_t>(getpid());

  const std::unique_ptr<WorldGateway> gateway = options.make_gateway ? options.make_gateway(scene) : nullptr;
  Driver driver(scene, options, coordinator, std::move(endpoint), recorder.value(), gateway.get(), trace.get(),
                observer);
  driver.Start();
  if (gateway) gateway->Connect(&driver);
  driver.Run(stop);
  if (gateway) gateway->Connect(nullptr);
  Result<RunSummary> summary = driver.Finish();
  if (Status error = recorder.value().Close(); error && summary.ok()) return *error;
  if (Status error = trace ? trace->Close() : std::nullopt; error && summary.ok()) return *error;
  return summary;
}

}  // namespace troupe
