#include "world-service/service/run_service.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <random>
#include <utility>

#include "common/base/version.h"
#include "world-service/service/event_text.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;
using Phase = TickCoordinator::Phase;

// Wall times, s.
constexpr double kStatusPeriod = 0.5;
constexpr double kLongestWait = 0.05;  // so that `stop`, and what there is to tell, need not wait for longer
constexpr double kFlushTime = 0.5;

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
  Driver(const Scene& scene, const CoordinatorOptions& options, std::unique_ptr<ServiceEndpoint> endpoint,
         Recorder& recorder, WorldGateway* gateway, TickTrace* trace, RunObserver& observer)
      : scene_(scene),
        observer_(observer),
        trace_(trace),
        coordinator_(scene, options, *endpoint, recorder, Now(), gateway),
        endpoint_(std::move(endpoint)) {}

  void Start(const SessionMessage& session) {
    session_ = session;
    endpoint_->Start(*this);
    endpoint_->SendSession(session);
  }

  // Until the run is over.
  void Run(const std::atomic<bool>& stop) {
    std::unique_lock lock(mutex_);
    double next_status = Now() + kStatusPeriod;
    while (coordinator_.phase() != Phase::kOver) {
      const double now = Now();
      if (stop) coordinator_.Stop(now);
      coordinator_.Poll(now);
      if (trace_ != nullptr) trace_->WriteSome();
      const bool status_due = now >= next_status;
      if (status_due) next_status = now + kStatusPeriod;
      Tell(status_due, lock);

      wake_at_ = std::clamp(coordinator_.NextPoll(), now, now + kLongestWait);
      wake_.wait_until(lock, TimePoint(wake_at_));
    }
    Tell(true, lock);
  }

  void Request(const ControlRequest& request, ControlReplyTo reply) override {
    Handle([&](double now) { coordinator_.Control(request, std::move(reply), now); });
  }
  FrameMessage CurrentFrame() override {
    const std::lock_guard lock(mutex_);
    return coordinator_.frame();
  }

  // REQUIRES: Run has returned.
  Result<RunSummary> Finish() {
    endpoint_->Flush(kFlushTime);
    const std::lock_guard lock(mutex_);
    if (coordinator_.error()) return *coordinator_.error();
    return coordinator_.MakeSummary();
  }

 private:
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
    bool begun = false;
    Handle([&](double now) {
      coordinator_.OnRivalService(rival, now);
      begun = coordinator_.startup_seconds().has_value();
    });
    if (!begun || rival.begun) return;
    session_.begun = true;  // for the rival, which cannot know
    endpoint_->SendSession(session_);
  }

  void OnControl(const ControlRequest& request) override {
    Request(request, [this](const ControlReply& reply) { endpoint_->SendControlReply(reply); });
  }

  template <typename Call>
  void Handle(const Call& call) {
    bool wake = false;
    {
      const std::lock_guard lock(mutex_);
      call(Now());
      wake = coordinator_.NextPoll() < wake_at_;
    }
    if (wake) wake_.notify_one();
  }

  // Tells the observer what is new. The lock is open meanwhile: ticks do not wait for an observer.
  void Tell(bool with_status, std::unique_lock<std::mutex>& lock) {
    const std::vector<std::string> notices = coordinator_.TakeNotices();
    const std::vector<Event> events = coordinator_.TakeEvents();
    const std::optional<double> startup = started_ ? std::nullopt : coordinator_.startup_seconds();
    std::optional<StatusMessage> status;
    if (with_status) status = coordinator_.MakeStatus(Now());
    if (startup) started_ = true;

    lock.unlock();
    for (const std::string& notice : notices) observer_.OnNotice(notice);
    if (startup) observer_.OnStarted(*startup);
    for (const Event& event : events) observer_.OnEvent(event, EventText(scene_.world(), event));
    if (status) {
      endpoint_->SendStatus(*status);
      observer_.OnStatus(*status);
    }
    lock.lock();
  }

  const Scene& scene_;
  RunObserver& observer_;
  TickTrace* const trace_;  // null: none
  SessionMessage session_;
  bool started_ = false;  // the observer knows
  std::mutex mutex_;      // for what follows
  std::condition_variable wake_;
  double wake_at_ = 0.0;  // when Run wakes up by itself
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

  SessionMessage session;
  session.run = coordinator.run;
  session.protocol_version = kProtocolVersion;
  session.host = HostName();
  session.pid = static_cast<std::uint32_t>(getpid());
  session.lease_seconds = options.lease_seconds;
  session.world = scene.world();

  const std::unique_ptr<WorldGateway> gateway = options.make_gateway ? options.make_gateway(scene) : nullptr;
  Driver driver(scene, coordinator, std::move(endpoint), recorder.value(), gateway.get(), trace.get(), observer);
  driver.Start(session);
  if (gateway) gateway->Connect(&driver);
  driver.Run(stop);
  if (gateway) gateway->Connect(nullptr);
  Result<RunSummary> summary = driver.Finish();
  if (Status error = recorder.value().Close(); error && summary.ok()) return *error;
  if (Status error = trace ? trace->Close() : std::nullopt; error && summary.ok()) return *error;
  return summary;
}

}  // namespace troupe
