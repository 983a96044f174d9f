#include "robot-agent/agent/agent_host.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>

#include "common/base/version.h"
#include "robot-agent/agent/replica.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// How soon a join is repeated when it is not answered, and how often `stop` is looked at.
constexpr auto kPeriod = std::chrono::milliseconds(100);
// A join is repeated more and more seldom, down to this.
constexpr auto kLongestPeriod = std::chrono::milliseconds(3200);

// Where an agent is in its life. Messages that belong to another stage change nothing.
enum class Stage : std::uint8_t {
  kWaiting,    // for a session
  kPreparing,  // building the replica of run_
  kJoining,    // joins are sent
  kRunning,    // admitted: frames are answered
  kRunOver,    // the service said so
  kFailed,     // failure_ says why
};

// Frames in their order: a tick that is paused comes paused first, and then to be gone on from.
using FramePlace = std::tuple<Edition, Tick, bool>;
FramePlace PlaceOf(const FrameMessage& frame) {
  return {frame.edition, frame.state.tick, !frame.paused};
}
bool IsOneTick(const FramePlace& a, const FramePlace& b) {
  return std::get<Edition>(a) == std::get<Edition>(b) && std::get<Tick>(a) == std::get<Tick>(b);
}

std::string HostName() {
  char name[256] = "";
  gethostname(name, sizeof(name) - 1);
  return name;
}

std::string TraceName(const std::vector<std::string>& robots) {
  if (robots.empty()) return "robot-agent";
  return "robot-agent " + robots.front() + (robots.size() > 1 ? fmt::format(" and {} more", robots.size() - 1) : "");
}

// Run() works on the caller's thread until the agent is admitted, and then only waits: frames are answered on the
// transport's thread that brings them, without a hand-over.
class AgentHost final : public AgentHandler {
 public:
  AgentHost(AgentEndpoint& endpoint, const AgentOptions& options, const std::atomic<bool>& stop)
      : endpoint_(endpoint), options_(options), stop_(stop) {}

  Result<bool> Run();
  bool bad_request() const { return bad_request_; }

  void OnSession(const SessionMessage& session) override;
  void OnAdmission(const AdmissionMessage& admission) override;
  void OnFrame(const FrameMessage& frame) override;
  void OnServiceGone() override;

 private:
  Status OpenOutputs();
  // Waits for a session and makes the replica for it; an error, or nothing (also when told to stop).
  Status Prepare();
  // Sends joins until something else happens.
  void Join();
  void WaitUntilOver();
  bool stopping() const { return stop_.load(std::memory_order_relaxed); }

  // With mutex_ held:
  void Answer(const FrameMessage& frame);
  // Brings the replica to the world of a new frame, and its robots; false if the frame cannot be answered (yet).
  bool Follow(const FrameMessage& frame);
  void Fail(Error error);

  AgentEndpoint& endpoint_;
  const AgentOptions& options_;
  const std::atomic<bool>& stop_;
  std::unique_ptr<ScanLog> scan_log_;
  std::unique_ptr<TickTrace> trace_;  // null: none
  std::mutex mutex_;                  // guards everything below
  std::condition_variable changed_;   // the stage changed, or a session came
  Stage stage_ = Stage::kWaiting;
  std::unique_ptr<SessionMessage> session_;  // came, and was not yet taken up
  RunId run_ = 0;                            // from preparing on
  JoinMessage join_;                         // from joining on
  std::unique_ptr<Replica> replica_;         // from joining on
  Edition world_edition_ = 0;                // of the replica
  std::optional<Edition> fresh_edition_;     // since which its robots are; nothing: since they joined
  std::optional<FrameMessage> early_frame_;  // the newest one that came before the admission, or before its world
  std::optional<FramePlace> answered_;       // of the frame that answer_ answers
  ProposalMessage answer_;
  Error failure_;
  bool bad_request_ = false;  // as in RunAgent
};

Result<bool> AgentHost::Run() {
  if (Status status = OpenOutputs()) {
    bad_request_ = true;
    return *status;
  }
  endpoint_.Start(*this);
  while (!stopping()) {
    if (Status status = Prepare()) return *status;
    Join();
    WaitUntilOver();
    const std::lock_guard lock(mutex_);
    if (stage_ == Stage::kFailed) return failure_;
    if (stage_ == Stage::kRunOver) break;
  }
  const std::lock_guard lock(mutex_);
  if (scan_log_) {
    if (Status status = scan_log_->Flush()) return *status;
  }
  if (trace_) {
    if (Status status = trace_->Close()) return *status;
  }
  return stage_ == Stage::kRunOver;
}

Status AgentHost::OpenOutputs() {
  if (!options_.scan_log.empty()) {
    Result<std::unique_ptr<ScanLog>> log = ScanLog::Open(options_.scan_log, options_.keep_scan_log);
    if (!log.ok()) return log.error();
    scan_log_ = std::move(log).value();
  }
  if (!options_.trace.file.empty()) {
    Result<std::unique_ptr<TickTrace>> trace = TickTrace::Create(options_.trace, TraceName(options_.robots));
    if (!trace.ok()) return trace.error();
    trace_ = std::move(trace).value();
  }
  return {};
}

Status AgentHost::Prepare() {
  std::unique_ptr<SessionMessage> session;
  {
    const auto deadline = Clock::now() + std::chrono::duration<double>(options_.session_timeout_seconds);
    std::unique_lock lock(mutex_);
    while (!session_) {
      if (stopping()) return {};
      if (options_.session_timeout_seconds > 0.0 && Clock::now() >= deadline) {
        return Error{{}, fmt::format("no world service appeared within {} s", options_.session_timeout_seconds)};
      }
      changed_.wait_for(lock, kPeriod);
    }
    session = std::move(session_);
    run_ = session->run;
    world_edition_ = session->world_edition;
    stage_ = Stage::kPreparing;
  }
  if (session->protocol_version != kProtocolVersion) {
    return Error{{},
                 fmt::format("the world service on {} speaks protocol version {}, expected {}", session->host,
                             session->protocol_version, kProtocolVersion)};
  }
  if (Status status = Validate(session->world)) {
    return Error{{}, fmt::format("the world service on {} sent a bad world: {}", session->host, status->message)};
  }
  JoinMessage join{.run = session->run,
                   .agent = options_.agent,
                   .protocol_version = kProtocolVersion,
                   .world_hash = Hash(session->world),
                   .host = HostName(),
                   .pid = static_cast<std::uint32_t>(getpid()),
                   .robots = {},
                   .world_edition = session->world_edition};
  Result<std::unique_ptr<Replica>> replica =
      Replica::Create(std::move(session->world), options_.robots, scan_log_.get(), options_.threads,
                      options_.make_gateway, trace_.get());
  const std::lock_guard lock(mutex_);
  if (!replica.ok()) {
    bad_request_ = true;
    return replica.error();
  }
  if (stage_ != Stage::kPreparing) return {};  // the run ended meanwhile
  join.robots = replica.value()->RobotNames();
  replica_ = std::move(replica).value();
  join_ = std::move(join);
  answered_.reset();
  fresh_edition_.reset();
  stage_ = Stage::kJoining;
  return {};
}

void AgentHost::Join() {
  std::unique_lock lock(mutex_);
  auto due = Clock::now();
  Clock::duration period = kPeriod;
  while (stage_ == Stage::kJoining && !stopping()) {
    if (Clock::now() >= due) {
      const JoinMessage join = join_;
      lock.unlock();  // sending may wait for a delivery that waits for the lock
      endpoint_.SendJoin(join);
      lock.lock();
      // Where hundreds wait for the run to begin, asking again soon would hold the service up.
      due = Clock::now() + period;
      period = std::min<Clock::duration>(2 * period, kLongestPeriod);
    }
    changed_.wait_for(lock, kPeriod, [this] { return stage_ != Stage::kJoining; });
  }
}

void AgentHost::WaitUntilOver() {
  std::unique_lock lock(mutex_);
  while (stage_ == Stage::kRunning && !stopping()) changed_.wait_for(lock, kPeriod);
}

void AgentHost::OnSession(const SessionMessage& session) {
  const std::lock_guard lock(mutex_);
  const bool chosen = stage_ == Stage::kPreparing || stage_ == Stage::kJoining;
  const bool edited = session.run == run_ && session.world_edition > world_edition_;
  if (stage_ == Stage::kRunning) {
    if (!edited || (session_ && session.world_edition <= session_->world_edition)) return;
    session_ = std::make_unique<SessionMessage>(session);
    if (early_frame_) Answer(*std::exchange(early_frame_, std::nullopt));
    return;
  }
  if (chosen ? session.run == run_ && !edited : stage_ != Stage::kWaiting) return;
  // Once one was chosen, this is its world after an edit, or the next run in the place of one that ended before it
  // answered.
  session_ = std::make_unique<SessionMessage>(session);
  stage_ = Stage::kWaiting;
  if (!edited) early_frame_.reset();
  changed_.notify_all();
}

void AgentHost::OnAdmission(const AdmissionMessage& admission) {
  const std::lock_guard lock(mutex_);
  const bool joined = stage_ == Stage::kJoining || stage_ == Stage::kRunning;
  if (!joined || admission.run != run_ || admission.agent != options_.agent) return;
  if (!admission.admitted) {
    bad_request_ = true;
    return Fail({{}, "the world service refused: " + admission.reason});
  }
  if (stage_ == Stage::kRunning) return;
  stage_ = Stage::kRunning;
  changed_.notify_all();
  if (early_frame_) Answer(*std::exchange(early_frame_, std::nullopt));
}

void AgentHost::OnFrame(const FrameMessage& frame) {
  const std::lock_guard lock(mutex_);
  const bool chosen = stage_ == Stage::kPreparing || stage_ == Stage::kJoining || stage_ == Stage::kRunning;
  if (!chosen || frame.run != run_) return;
  if (frame.last) {
    stage_ = Stage::kRunOver;
    changed_.notify_all();
  } else if (stage_ == Stage::kRunning) {
    Answer(frame);
  } else if (!early_frame_ || PlaceOf(frame) > PlaceOf(*early_frame_)) {
    early_frame_ = frame;
  }
}

void AgentHost::OnServiceGone() {
  const std::lock_guard lock(mutex_);
  if (stage_ == Stage::kRunning) {
    Fail({{}, "the world service is gone"});
  } else if (stage_ == Stage::kWaiting || stage_ == Stage::kPreparing || stage_ == Stage::kJoining) {
    // A service that left before it answered may be replaced by another one.
    session_.reset();
    early_frame_.reset();
    stage_ = Stage::kWaiting;
    changed_.notify_all();
  }
}

void AgentHost::Answer(const FrameMessage& frame) {
  const FramePlace place = PlaceOf(frame);
  if (answered_ && place < *answered_) return;
  const bool is_new = !answered_ || place > *answered_;
  if (!is_new && !frame.awaited.empty() &&
      std::find(frame.awaited.begin(), frame.awaited.end(), options_.agent) == frame.awaited.end()) {
    return;  // the answer has arrived
  }
  const Tick next = frame.state.tick + 1;
  const bool is_shown = answered_ && IsOneTick(*answered_, place);
  if (is_new) {
    if (!Follow(frame)) return;
    Enter(replica_->lane(), TickPhase::kApply, next);
    if (const std::string problem = replica_->CheckState(frame.state); !problem.empty()) {
      return Fail({{}, "the world service sent a bad frame: " + problem});
    }
    const bool was_edited = answered_ && std::get<Edition>(*answered_) != frame.edition;
    if (was_edited) replica_->Carry(frame.state);
    answer_.run = run_;
    answer_.agent = options_.agent;
    answer_.edition = frame.edition;
    if (frame.paused) {
      replica_->Hold(frame.state, answer_);
      replica_->Publish(frame.state);  // first: who has paused or stepped is told when all has been shown
    } else {
      replica_->Answer(frame.state, answer_);
    }
    answered_ = place;
    if (scan_log_ && scan_log_->status()) return Fail(*scan_log_->status());
  }
  Enter(replica_->lane(), TickPhase::kSend, next);
  endpoint_.SendProposal(answer_);
  if (is_new && !is_shown && !frame.paused) replica_->Publish(frame.state);  // last, so that no tick waits for it
  if (!trace_) return;
  trace_->WriteSome();
  Enter(replica_->lane(), TickPhase::kWait, next + 1);
}

bool AgentHost::Follow(const FrameMessage& frame) {
  const bool fresh = fresh_edition_ && frame.fresh_edition > *fresh_edition_;
  const bool edited = frame.world_edition != world_edition_;
  if (edited && (!session_ || session_->world_edition != frame.world_edition)) {
    early_frame_ = frame;  // its world is on the way
    return false;
  }
  Status problem;
  try {
    if (edited) {
      const std::unique_ptr<SessionMessage> session = std::move(session_);
      problem = Validate(session->world);
      if (!problem) problem = replica_->ChangeWorld(std::move(session->world), fresh, frame.fresh_edition);
      world_edition_ = frame.world_edition;
    } else if (fresh) {
      problem = replica_->Renew(frame.fresh_edition);
    }
  } catch (const std::exception& exception) {
    problem = Error{{}, exception.what()};
  }
  if (!fresh_edition_ && frame.fresh_edition > 0 && scan_log_) scan_log_->Restart(frame.fresh_edition);
  fresh_edition_ = frame.fresh_edition;
  if (problem) {
    Fail({{}, "the world was edited, and this agent cannot go on: " + problem->message});
    return false;
  }
  if (replica_->has_robots()) return true;
  stage_ = Stage::kRunOver;  // all its robots are gone
  changed_.notify_all();
  return false;
}

void AgentHost::Fail(Error error) {
  stage_ = Stage::kFailed;
  failure_ = std::move(error);
  changed_.notify_all();
}

}  // namespace

Result<bool> RunAgent(std::unique_ptr<AgentEndpoint> endpoint, const AgentOptions& options,
                      const std::atomic<bool>& stop, bool* bad_request) {
  AgentHost host(*endpoint, options, stop);
  Result<bool> result = host.Run();
  endpoint.reset();  // while the host that it delivers to is there
  if (bad_request != nullptr) *bad_request = host.bad_request();
  return result;
}

}  // namespace troupe
