#include "world-service/service/run_service.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <new>
#include <random>
#include <thread>
#include <utility>

#include "common/base/identity.h"
#include "common/base/or_failure.h"
#include "world-service/service/event_log.h"
#include "world-service/service/requested_file.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;
using Phase = TickCoordinator::Phase;

// Wall times, s.
constexpr double kStatusPeriod = 0.5;
constexpr double kTurnGap = 1e-4;  // for deliveries, between turns that ask for the next one
constexpr double kMaxWait = 0.05;  // so that `stop` and progress reports need not wait for longer
// For the last frame and replies to leave the process; peers that do not acknowledge them delay the end by no more.
constexpr double kFlushTime = 0.5;

constexpr std::size_t kMaxFileRequests = 100;  // a hostile tool may send any number

double Now() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

Clock::time_point TimePoint(double seconds) {
  return Clock::time_point(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
}

RunId MakeRunId() {
  std::random_device device;
  // Random, not from the seed: two runs of one scenario in one session have to be told apart. It enters no hash.
  return (static_cast<RunId>(device()) << 32) | device();
}

// Serializes the transport's threads and the one that waits for time to pass at one coordinator.
class Driver final : public WorldControl, private ServiceHandler {
 public:
  Driver(const std::shared_ptr<const Scene>& scene, const ServiceOptions& service, const CoordinatorOptions& options,
         std::unique_ptr<ServiceEndpoint> endpoint, const RunObservers& observers, TickTrace* trace)
      : service_(service),
        observers_(observers),
        trace_(trace),
        coordinator_(scene, options, *endpoint, observers, Now()),
        endpoint_(std::move(endpoint)) {}

  void Start() {
    {
      const std::lock_guard lock(mutex_);
      is_started_ = true;
    }
    // Deliveries may begin before the session is announced, for instance joins of agents that know it from a service
    // before.
    endpoint_->Start(*this);
    Deliver([&](double) { coordinator_.Announce(); });
  }

  // Until the run is over.
  void Run(const std::atomic<bool>& stop) {
    std::unique_lock lock(mutex_);
    double next_status = Now() + kStatusPeriod;
    while (coordinator_.phase() != Phase::kOver) {
      const double now = Now();
      Act([&] {
        coordinator_.AdvanceRewind(now);
        if (stop) coordinator_.Stop(now);
        if (std::exchange(is_woken_, false)) {
          coordinator_.Wake(now);
        } else {
          coordinator_.Poll(now);
        }
      });
      if (trace_ != nullptr) {
        const Status& written = trace_->WriteSome();
        if (!written.ok()) Act([&] { coordinator_.Fail(written.error(), now); });
      }
      const bool status_due = now >= next_status;
      if (status_due) next_status = now + kStatusPeriod;
      // At once and not with the next status: the launcher starts further agents when earlier ones have joined.
      if (AgentsHaveJoined()) ReportJoins(lock);
      Report(status_due, lock);
      ReadFiles(lock);
      SendHistories(lock);
      if (coordinator_.rewind().is_running()) {
        // Slow, so without the lock: no message may wait for it.
        lock.unlock();
        coordinator_.rewind().Work(*service_.history);
        lock.lock();
        continue;
      }
      // Deliver compares with it, so that a delivery wakes this thread only if it has to act earlier than planned.
      wake_at_ = is_woken_ ? Now() + kTurnGap : std::clamp(coordinator_.NextPoll(), now, now + kMaxWait);
      if (file_requests_.empty()) wake_.wait_until(lock, TimePoint(wake_at_));
    }
    Report(true, lock);
    Act([&] {
      for (const AskedRequest& open : std::exchange(file_requests_, {})) {
        coordinator_.Reply(open.reply, Error{{}, "the run is over"});
      }
    });
  }

  void Request(const control::Request& request, ControlReplyTo reply) override {
    // The mutex is not recursive, and the coordinator is in the middle of a call: the request follows when that
    // returns.
    if (acting_ == std::this_thread::get_id()) {
      asked_meanwhile_.push_back({request, std::move(reply)});  // from inside a reply: this thread has the lock
      return;
    }
    Deliver([&](double) { Accept({request, std::move(reply)}); });
  }

  void Wake() override {
    if (acting_ == std::this_thread::get_id()) {
      is_woken_ = true;
      return;
    }
    Deliver([&](double now) {
      // Observers may wake the run from their own begin on; it begins after that of all.
      if (is_started_) return coordinator_.Wake(now);
      is_woken_ = true;
    });
  }

  void OnAgentNews(const AgentNews& news) override {
    Deliver([&](double now) { coordinator_.OnAgentNews(news, now); });
  }

  // REQUIRES: Run has returned.
  Result<RunSummary> Finish() {
    endpoint_->Flush(kFlushTime);
    const std::lock_guard lock(mutex_);
    if (!coordinator_.error().ok()) return coordinator_.error().error();
    if (!report_failure_.ok()) return report_failure_.error();
    return coordinator_.MakeSummary();
  }

 private:
  struct AskedRequest {
    control::Request request;
    ControlReplyTo reply;
  };

  // Makes a call to the coordinator, and then executes the requests made from inside its replies. An exception, as for
  // lack of memory, ends the run in order. REQUIRES: mutex_ is locked.
  template <typename Call>
  void Act(const Call& call) {
    acting_ = std::this_thread::get_id();
    const Status outcome = OrFailure([&] {
      call();
      while (!asked_meanwhile_.empty()) {
        AskedRequest next = std::move(asked_meanwhile_.front());
        asked_meanwhile_.pop_front();
        Accept(std::move(next));
      }
      return Status();
    });
    if (!outcome.ok()) {
      // A second exception changes nothing: the run is ending.
      (void)OrFailure([&] {
        coordinator_.Fail(outcome.error(), Now());
        return Status();
      });
    }
    acting_ = std::thread::id();
  }

  void Accept(AskedRequest asked) {
    if (control::Is<control::GetStatus>(asked.request)) {
      const auto with_files = [&](ControlReply content) {
        content.open_requests += static_cast<std::uint32_t>(file_requests_.size());
        asked.reply(content);
      };
      return coordinator_.Control(asked.request, with_files, Now());
    }
    if (control::Is<control::World>(asked.request)) {
      return coordinator_.Reply(asked.reply, LoadedFile());
    }
    if (!NeedsFiles(asked.request)) {
      return coordinator_.Control(asked.request, std::move(asked.reply), Now());
    }
    // Files are slow, so Run reads them: no message may wait for one.
    if (coordinator_.phase() == Phase::kOver) {
      return coordinator_.Reply(asked.reply, Error{{}, "the run is over"});
    }
    if (file_requests_.size() >= kMaxFileRequests) {
      return coordinator_.Reply(asked.reply, Error{{}, "too many requests are waiting"});
    }
    file_requests_.push_back(std::move(asked));
  }

  // The file of the world, without a path if it was a text; nothing after the world was unloaded.
  std::vector<EntityReport> LoadedFile() const {
    if (service_.world_file.empty()) return {};
    const std::string stem = std::filesystem::path(service_.world_file).stem().string();
    return {{.name = stem, .type = text_ ? std::string() : service_.world_file}};
  }

  static bool NeedsFiles(const control::Request& request) {
    return control::Is<control::LoadWorld>(request) || control::Is<control::Spawn>(request) ||
           control::Is<control::Spawnables>(request) || control::Is<control::Worlds>(request);
  }

  void ReadFiles(std::unique_lock<std::mutex>& lock) {
    while (!file_requests_.empty()) {
      const AskedRequest open = file_requests_.front();  // it is open while its file is read
      lock.unlock();
      const Result<RequestedFile> file = ReadRequestedFile(service_, open.request);
      lock.lock();
      file_requests_.pop_front();
      Act([&] { Execute(open, file); });
    }
  }

  void SendHistories(std::unique_lock<std::mutex>& lock) {
    for (TickCoordinator::HistoryDemand& demand : coordinator_.DrainHistoryDemands(Now())) {
      const RunId run = coordinator_.frame().run;
      const Incarnation incarnation = coordinator_.frame().incarnation;
      lock.unlock();
      const Status failure = OrFailure([&]() -> Status {
        Result<std::vector<HistoryEntry>> entries = service_.history->Read(demand.request);
        if (!entries.ok()) return entries.error();
        for (HistoryEntry& entry : entries.value()) entry.frame.run = run;
        endpoint_->SendHistory({run, std::move(demand.agents), demand.after, std::move(entries).value(), incarnation});
        return {};
      });
      lock.lock();
      if (!failure.ok()) Act([&] { coordinator_.Fail(failure.error(), Now()); });
    }
  }

  void Execute(const AskedRequest& open, const Result<RequestedFile>& file) {
    if (!file.ok()) return coordinator_.Reply(open.reply, file.error());
    if (control::KindOf(open.request) == RequestKind::kQuestion) {
      return coordinator_.Reply(open.reply, file.value().listed);
    }
    const auto* const load = std::get_if<control::LoadWorld>(&open.request);
    if (load != nullptr && coordinator_.phase() == Phase::kRunning) {
      text_ = file.value().text;
      // Models that later requests spawn are looked up in the world that is loaded now.
      service_.world_file = text_ ? text_->path() : load->source;
      if (text_) service_.overrides.allowed.Add(text_->path());
    }
    coordinator_.Control(open.request, open.reply, Now(), file.value().world);
  }

  void OnJoin(const JoinMessage& join) override {
    Deliver([&](double now) { coordinator_.OnJoin(join, now); });
  }
  void OnProposal(const ProposalMessage& proposal) override {
    Deliver([&](double now) { coordinator_.OnProposal(proposal, now); });
  }
  void OnSharedProposal(const SharedProposal& proposal) override {
    Deliver([&](double now) { coordinator_.OnProposal(*proposal, now, proposal); });
  }
  void OnAgentGone(AgentId agent) override {
    Deliver([&](double now) { coordinator_.OnAgentGone(agent, now); });
  }
  void OnAgentSilent(AgentId agent) override {
    Deliver([&](double now) { coordinator_.OnAgentSilent(agent, now); });
  }
  void OnRivalService(const SessionMessage& rival) override {
    Deliver([&](double now) { coordinator_.OnRivalService(rival, now); });
  }

  void OnOutOfMemory() override {
    Deliver([](double) { throw std::bad_alloc(); });
  }

  void OnControl(const ControlRequest& request) override {
    Request(request.request, [this, client = request.client, number = request.number](ControlReply reply) {
      reply.client = client;
      reply.number = number;
      endpoint_->SendControlReply(reply);
    });
  }

  template <typename Call>
  void Deliver(const Call& call) {
    bool wake = false;
    {
      const std::lock_guard lock(mutex_);
      Act([&] { call(Now()); });
      // Under the lock: otherwise Run could compute wake_at_ from the state before this delivery, and sleep too long.
      wake = coordinator_.NextPoll() < wake_at_ || is_woken_ || !file_requests_.empty() ||
             coordinator_.rewind().is_running() || AgentsHaveJoined();
    }
    if (wake) wake_.notify_one();
  }

  // Before the run begins, the launcher may wait for agents to join before it starts more.
  bool AgentsHaveJoined() const {
    return coordinator_.phase() == Phase::kGathering && coordinator_.present_agents() != reported_agents_;
  }
  void ReportJoins(std::unique_lock<std::mutex>& lock) {
    reported_agents_ = coordinator_.present_agents();
    const StatusMessage status = coordinator_.MakeStatus(Now());
    ReportUnlocked(lock, [&] {
      for (RunObserver* observer : observers_) observer->OnStatus(status);
    });
  }

  template <typename Reports>
  void ReportUnlocked(std::unique_lock<std::mutex>& lock, const Reports& reports) {
    lock.unlock();
    const Status outcome = OrFailure([&] {
      reports();
      return Status();
    });
    lock.lock();
    if (outcome.ok()) return;
    if (report_failure_.ok()) report_failure_ = outcome;
    Act([&] { coordinator_.Fail(outcome.error(), Now()); });
  }

  // Reports progress to the observers, without the lock, so that ticks do not wait for them.
  void Report(bool with_status, std::unique_lock<std::mutex>& lock) {
    const std::vector<std::string> notices = coordinator_.DrainNotices();
    const std::vector<Event> events = coordinator_.DrainEvents();
    const std::vector<std::string> new_robots = coordinator_.DrainNewRobots();
    const Edition edition = coordinator_.frame().edition;
    // Everything is copied under the lock and reported without it: a slow console must not delay a tick.
    const std::shared_ptr<const Scene> scene = coordinator_.scene();  // that the events are of
    const std::optional<double> startup = started_ ? std::nullopt : coordinator_.startup_seconds();
    std::optional<StatusMessage> status;
    if (with_status) status = coordinator_.MakeStatus(Now());
    if (startup) started_ = true;

    ReportUnlocked(lock, [&] {
      const std::vector<ToldEvent> told = ToldEvents(scene->world(), events);
      if (status) endpoint_->SendStatus(*status);
      for (RunObserver* observer : observers_) {
        for (const std::string& notice : notices) observer->OnNotice(notice);
        if (startup) observer->OnStarted(*startup);
        if (!new_robots.empty()) observer->OnNewRobots(new_robots, edition);
        for (const auto& [event, text] : told) observer->OnEvent(event, text);
        if (status) observer->OnStatus(*status);
      }
    });
  }

  ServiceOptions service_;
  std::shared_ptr<const RequestedText> text_;  // of the world, if it was no file
  const RunObservers observers_;
  TickTrace* const trace_;  // null: none
  bool started_ = false;    // reported to the observers
  Status report_failure_;   // the first exception of an observer in a report
  std::mutex mutex_;        // guards the members below
  std::condition_variable wake_;
  std::size_t reported_agents_ = 0;  // present at the newest report
  double wake_at_ = 0.0;             // when Run wakes up by itself
  std::deque<AskedRequest> file_requests_;
  std::deque<AskedRequest> asked_meanwhile_;
  bool is_started_ = false;  // all observers have begun
  bool is_woken_ = false;    // from inside a call of the coordinator: Run makes another one
  std::atomic<std::thread::id> acting_ = std::thread::id();  // the thread that is inside the coordinator
  TickCoordinator coordinator_;
  std::unique_ptr<ServiceEndpoint> endpoint_;  // last: it ends before the members that its deliveries use
};

CoordinatorOptions MakeCoordinatorOptions(const ServiceOptions& options, TickTrace* trace, PhaseTimes& phase_times) {
  CoordinatorOptions coordinator;
  coordinator.settings = options.settings;
  coordinator.run = options.resumed ? options.resumed->run : MakeRunId();
  coordinator.incarnation = options.resumed ? options.resumed->incarnation : options.first_incarnation;
  coordinator.resumed = options.resumed;
  coordinator.lease_seconds = options.lease_seconds;
  coordinator.lease_is_limit = options.lease_is_limit;
  coordinator.start_timeout_seconds = options.start_timeout_seconds;
  coordinator.advice_on_silence = options.advice_on_silence;
  coordinator.check_world = options.check_world;
  coordinator.check_in_world = options.overrides.check_in_world;
  coordinator.check_goal = options.check_goal;
  coordinator.start_paused = options.start_paused;
  coordinator.has_history = options.history != nullptr;
  coordinator.pool = options.pool;
  coordinator.scenes = options.scenes;
  if (trace != nullptr) coordinator.trace = trace->AddLane();
  coordinator.phase_times = &phase_times;
  coordinator.host = HostName();
  coordinator.pid = static_cast<std::uint32_t>(getpid());
  return coordinator;
}

}  // namespace

Result<RunSummary> RunService(const std::shared_ptr<const Scene>& scene, const ServiceOptions& options,
                              std::unique_ptr<ServiceEndpoint> endpoint, const RunObservers& observers,
                              const std::atomic<bool>& stop) {
  std::unique_ptr<TickTrace> trace;
  if (!options.trace.file.empty()) {
    Result<std::unique_ptr<TickTrace>> created = TickTrace::Create(options.trace, "world-service");
    if (!created.ok()) return created.error();
    trace = std::move(created).value();
  }
  PhaseTimes phase_times;
  const CoordinatorOptions coordinator = MakeCoordinatorOptions(options, trace.get(), phase_times);
  RobotTotals totals;
  TripTotals trips;
  RunObservers all = observers;
  all.push_back(&totals);
  all.push_back(&trips);
  Driver driver(scene, options, coordinator, std::move(endpoint), all, trace.get());

  Status failure;  // the first
  const auto note = [&failure](const Status& outcome) {
    if (failure.ok()) failure = outcome;
  };
  RunObservers begun;
  const bool continues = options.resumed && options.resumed->frame;
  const Tick tick = continues ? options.resumed->frame->state.tick : 0;
  for (RunObserver* observer : all) {
    failure = OrFailure([&] {
      return observer->OnBegin({coordinator.run, options.settings, scene, driver, tick, coordinator.incarnation});
    });
    if (!failure.ok()) break;
    // OnEnd follows for exactly those whose OnBegin succeeded, so that files of the first are closed if the second
    // fails.
    begun.push_back(observer);
  }
  const bool all_begun = failure.ok();
  if (all_begun) {
    note(OrFailure([&] {
      driver.Start();
      driver.Run(stop);
      return Status();
    }));
  }
  for (RunObserver* observer : begun) note(OrFailure([&] { return observer->OnEnd(); }));
  if (!all_begun) return failure.error();
  Result<RunSummary> summary = driver.Finish();
  if (summary.ok()) {
    summary.value().totals = totals.Collect(kMaxRobotTotals);
    summary.value().traffic = totals.traffic();
    summary.value().waits = totals.FindWaits(kMaxWaitPlaces);
    summary.value().totals_since = totals.since();
    summary.value().flows = totals.CollectFlows();
    summary.value().cleaning = totals.CollectCleaning();
    summary.value().trips = trips.Collect();
  }
  if (trace) note(trace->Close());
  if (summary.ok() && !failure.ok()) return failure.error();
  return summary;
}

}  // namespace troupe
