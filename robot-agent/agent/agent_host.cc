#include "robot-agent/agent/agent_host.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include "robot-agent/agent/agent_protocol.h"
#include "robot-agent/robot/robot.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMaxWait = 3600.0;  // s; a clock cannot count to the end of time

double Now() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

std::string TraceName(const std::vector<std::string>& robots) {
  if (robots.empty()) return "robot-agent";
  return "robot-agent " + robots.front() + (robots.size() > 1 ? fmt::format(" and {} more", robots.size() - 1) : "");
}

// The files, in the order of their opening.
struct OutputFiles {
  std::unique_ptr<ScanLog> scan_log;
  std::unique_ptr<TickTrace> trace;

  Status Open(const AgentOptions& options) {
    if (!options.scan_log.empty()) {
      Result<std::unique_ptr<ScanLog>> log = ScanLog::Open(options.scan_log, options.keep_scan_log);
      if (!log.ok()) return log.error();
      scan_log = std::move(log).value();
    }
    if (!options.trace.file.empty()) {
      Result<std::unique_ptr<TickTrace>> created = TickTrace::Create(options.trace, TraceName(options.robots));
      if (!created.ok()) return created.error();
      trace = std::move(created).value();
    }
    return {};
  }
  Status Close() const {
    if (scan_log) {
      if (Status status = scan_log->Flush(); !status.ok()) return status;
    }
    return trace ? trace->Close() : Status();
  }
};

// Frames are answered on the transport's delivery thread, without a hand-over. The agent's own thread, which calls
// Run(), sends joins and performs the tasks of the replica.
class AgentHost final : public AgentHandler {
 public:
  AgentHost(AgentEndpoint& endpoint, const AgentOptions& options, const AgentResources& resources, std::stop_token stop)
      : endpoint_(endpoint),
        options_(options),
        resources_(resources),
        stop_(std::move(stop)),
        protocol_(endpoint, options, resources, Now()) {}

  // Until the agent has ended, or a stop request.
  Result<AgentEnd> Run() {
    endpoint_.Start(*this);
    // Under the lock: the waiting thread has either not tested the request yet, or is waiting.
    const std::stop_callback wake(stop_, [this] {
      const std::lock_guard lock(mutex_);
      changed_.notify_all();
    });
    std::unique_lock lock(mutex_);
    while (!protocol_.over() && !stop_.stop_requested()) Advance(lock);
    Report(lock);
    if (!protocol_.failure().ok()) return protocol_.failure().error();
    return protocol_.over() ? AgentEnd::kRunOver : AgentEnd::kStopped;
  }

  void OnSession(const SessionMessage& session) override {
    Deliver([&] { protocol_.OnSession(session); });
  }
  void OnAdmission(const AdmissionMessage& admission) override {
    Deliver([&] { protocol_.OnAdmission(admission); });
  }
  void OnFrame(const FrameMessage& frame) override {
    Deliver([&] { protocol_.OnFrame(frame, Now()); });
  }
  void OnCheckedFrame(const FrameMessage& frame) override {
    Deliver([&] { protocol_.OnFrame(frame, Now(), true); });
  }
  void OnHistory(const HistoryMessage& history) override {
    Deliver([&] { protocol_.OnHistory(history); });
  }
  void OnServiceGone() override {
    Deliver([&] { protocol_.OnServiceGone(Now()); });
  }
  void OnServiceLost() override {
    Deliver([&] { protocol_.OnServiceLost(Now()); });
  }
  void OnOutOfMemory() override {
    Deliver([] { throw std::bad_alloc(); });
  }

 private:
  template <typename Call>
  void Deliver(const Call& call) {
    bool wake = false;
    {
      const std::lock_guard lock(mutex_);
      try {
        call();
      } catch (const std::bad_alloc& no_memory) {
        protocol_.Fail(FailureOf(no_memory));
      }
      // Most frames leave nothing to do for the other thread, which is then not woken.
      wake = protocol_.has_task() || protocol_.over() || protocol_.NextPoll() < wake_at_;
    }
    if (wake) changed_.notify_all();
  }

  // One action of the agent's own thread, or a wait.
  void Advance(std::unique_lock<std::mutex>& lock) {
    Report(lock);
    if (std::optional<ReplicaTask> task = protocol_.BeginTask()) {
      lock.unlock();
      task->Perform(options_, resources_);
      lock.lock();
      protocol_.FinishTask(*task);
      lock.unlock();
      task.reset();  // a replica of no use ends without the lock
      lock.lock();
      return;
    }
    const double now = Now();
    if (const std::optional<JoinMessage> join = protocol_.Poll(now)) {
      lock.unlock();  // a send may wait for a delivery, and that for the lock
      endpoint_.SendJoin(*join);
      lock.lock();
      return;
    }
    if (protocol_.over() || stop_.stop_requested()) return;
    wake_at_ = std::clamp(protocol_.NextPoll(), now, now + kMaxWait);
    changed_.wait_for(lock, std::chrono::duration<double>(wake_at_ - now));
  }

  void Report(std::unique_lock<std::mutex>& lock) {
    const std::vector<std::string> notices = protocol_.DrainNotices();
    if (notices.empty() || !options_.on_notice) return;
    lock.unlock();
    for (const std::string& notice : notices) options_.on_notice(notice);
    lock.lock();
  }

  AgentEndpoint& endpoint_;
  const AgentOptions& options_;
  const AgentResources resources_;
  const std::stop_token stop_;
  std::mutex mutex_;  // guards everything below
  std::condition_variable changed_;
  double wake_at_ = 0.0;  // when Run wakes up by itself
  AgentProtocol protocol_;
};

}  // namespace

Result<AgentEnd> RunAgent(std::unique_ptr<AgentEndpoint> endpoint, const AgentOptions& options, std::stop_token stop) {
  OutputFiles files;
  if (Status status = files.Open(options); !status.ok()) return status.error();
  const auto find_world = [&endpoint](const WorldDescription& world) { return endpoint->FindWorld(world); };
  const auto scenes = options.scenes != nullptr ? options.scenes : std::make_shared<SceneCache>();
  AgentHost host(*endpoint, options, {files.scan_log.get(), files.trace.get(), find_world, scenes}, std::move(stop));
  Result<AgentEnd> end = host.Run();
  endpoint.reset();  // its deliveries end before the files and the host do
  if (!end.ok()) return end;
  if (Status status = files.Close(); !status.ok()) {
    Error error = status.error();
    // The file could be opened: that it cannot be written to its end is no mistake of the caller.
    if (error.code == ErrorCode::kBadInput) error.code = ErrorCode::kFailure;
    return error;
  }
  return end;
}

}  // namespace troupe
