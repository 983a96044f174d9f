#include "robot-agent/agent/agent_host.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>

#include "common/base/host_name.h"
#include "common/base/version.h"
#include "robot-agent/agent/replica.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// From a join without an answer to the next one at first, and between checks of `stop`.
constexpr auto kPeriod = std::chrono::milliseconds(100);
// The period of joins doubles up to this.
constexpr auto kLongestPeriod = std::chrono::milliseconds(3200);

// Stages of an agent. Messages of another stage change nothing.
enum class Stage : std::uint8_t {
  kWaiting,    // for a session
  kPreparing,  // building the replica of run_
  kJoining,    // joins are sent
  kRunning,    // admitted: frames are answered
  kChanging,   // admitted: the replica is being changed as change_ says
  kRunOver,    // the service ended the run, or all robots were removed
  kFailed,     // by failure_
};

// The order of frames: a tick that pauses has a paused frame first, then one to be answered with proposals.
using FramePlace = std::tuple<Edition, Tick, bool>;
FramePlace PlaceOf(const FrameMessage& frame) {
  return {frame.edition, frame.state.tick, !frame.paused};
}
bool IsOneTick(const FramePlace& a, const FramePlace& b) {
  return std::get<Edition>(a) == std::get<Edition>(b) && std::get<Tick>(a) == std::get<Tick>(b);
}

// A change of the replica that an edit asks for.
struct ReplicaChange {
  std::unique_ptr<SessionMessage> session;  // with the edited world; null: the world is as before
  bool fresh = false;                       // all robots start anew
  Edition fresh_edition = 0;                // of the newest fresh start
  bool is_member = false;                   // has answered the edition before, without which no edit is applied
};

// With the code of a failure: the caller cannot correct it.
Error AsFailure(Error error) {
  error.code = ErrorCode::kFailure;
  return error;
}

std::string TraceName(const std::vector<std::string>& robots) {
  if (robots.empty()) return "robot-agent";
  return "robot-agent " + robots.front() + (robots.size() > 1 ? fmt::format(" and {} more", robots.size() - 1) : "");
}

// Frames are answered on the transport's delivery thread, without a hand-over. The agent's own thread, which calls
// Run(), joins, and makes, changes and destroys the replica: the replica's gateway may have a DDS participant, whose
// end waits for all threads of DDS, so it must not end on one of them, nor while one of them waits for mutex_.
class AgentHost final : public AgentHandler {
 public:
  AgentHost(AgentEndpoint& endpoint, const AgentOptions& options, const std::atomic<bool>& stop)
      : endpoint_(endpoint), options_(options), stop_(stop) {}

  Result<AgentEnd> Run();

  void OnSession(const SessionMessage& session) override;
  void OnAdmission(const AdmissionMessage& admission) override;
  void OnFrame(const FrameMessage& frame) override;
  void OnServiceGone() override;

 private:
  Status OpenOutputs();
  // Waits for a session and prepares for it. Succeeds also on `stop`.
  Status Prepare();
  // Null on `stop`. Begins the stage kPreparing.
  Result<std::unique_ptr<SessionMessage>> WaitForSession();
  // Makes the replica for the session. Begins the stage kJoining.
  Status MakeReplica(std::unique_ptr<SessionMessage> session);
  // Sends joins until the stage changes.
  void Join();
  // Changes the replica after edits, until the run is over.
  void FollowEdits();
  // Of the agent's thread in the stage kChanging, without the lock.
  Status ApplyChange(const ReplicaChange& change);
  Status CloseOutputs();
  bool stopping() const { return stop_.load(std::memory_order_relaxed); }

  // With mutex_ held:
  // Answers a frame in the stage kRunning, or begins the stage kChanging if an edit came before the frame.
  void Process(const FrameMessage& frame);
  // Processes the kept frame, if there is one.
  void ProcessKept();
  // Keeps a frame that cannot be answered yet, unless a newer one is kept.
  void Keep(const FrameMessage& frame);
  void BeginChange(const FrameMessage& frame, bool fresh);
  // Applies change_, without the lock, and begins the next stage.
  void ChangeReplica(std::unique_lock<std::mutex>& lock);
  void Answer(const FrameMessage& frame);
  // Computes answer_ for a new frame; false if the frame cannot be answered.
  bool ComputeAnswer(const FrameMessage& frame);
  void Fail(Error error);

  AgentEndpoint& endpoint_;
  const AgentOptions& options_;
  const std::atomic<bool>& stop_;
  std::unique_ptr<ScanLog> scan_log_;
  std::unique_ptr<TickTrace> trace_;  // null: none
  std::mutex mutex_;                  // guards everything below
  std::condition_variable changed_;   // the stage changed, or a session arrived
  Stage stage_ = Stage::kWaiting;
  std::unique_ptr<SessionMessage> session_;  // arrived, and not yet used
  RunId run_ = 0;                            // from preparing on
  JoinMessage join_;                         // from joining on
  // From joining on. In the stages kPreparing and kChanging only the agent's thread uses it, without the lock.
  std::unique_ptr<Replica> replica_;
  Edition world_edition_ = 0;               // of the replica, or of change_
  ReplicaChange change_;                    // in the stage kChanging
  std::optional<Edition> fresh_edition_;    // the edition that its robots started at; nothing: no frame was answered
  std::optional<FrameMessage> kept_frame_;  // the newest one that cannot be answered yet
  std::optional<FramePlace> answered_;      // of the frame that answer_ answers
  ProposalMessage answer_;
  Error failure_;
};

Result<AgentEnd> AgentHost::Run() {
  if (Status status = OpenOutputs(); !status.ok()) return status.error();
  endpoint_.Start(*this);
  while (!stopping()) {
    if (Status status = Prepare(); !status.ok()) return status.error();
    Join();
    FollowEdits();
    const std::lock_guard lock(mutex_);
    if (stage_ == Stage::kFailed) return failure_;
    if (stage_ == Stage::kRunOver) break;
  }
  const std::lock_guard lock(mutex_);
  if (Status status = CloseOutputs(); !status.ok()) return AsFailure(status.error());
  return stage_ == Stage::kRunOver ? AgentEnd::kRunOver : AgentEnd::kStopped;
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

Status AgentHost::CloseOutputs() {
  if (scan_log_) {
    if (Status status = scan_log_->Flush(); !status.ok()) return status;
  }
  return trace_ ? trace_->Close() : Status();
}

Status AgentHost::Prepare() {
  Result<std::unique_ptr<SessionMessage>> session = WaitForSession();
  if (!session.ok()) return session.error();
  if (session.value() == nullptr) return {};
  const SessionMessage& found = *session.value();
  if (found.protocol_version != kProtocolVersion) {
    return Failure(fmt::format("the world service on {} speaks protocol version {}, expected {}", found.host,
                               found.protocol_version, kProtocolVersion));
  }
  if (const Status status = Validate(found.world); !status.ok()) {
    return Failure(fmt::format("the world service on {} sent a bad world: {}", found.host, status.error().message));
  }
  return MakeReplica(std::move(session).value());
}

Result<std::unique_ptr<SessionMessage>> AgentHost::WaitForSession() {
  const auto deadline = Clock::now() + std::chrono::duration<double>(options_.session_timeout_seconds);
  std::unique_lock lock(mutex_);
  while (!session_) {
    if (stopping()) return std::unique_ptr<SessionMessage>();
    if (options_.session_timeout_seconds > 0.0 && Clock::now() >= deadline) {
      return Failure(fmt::format("no world service appeared within {} s", options_.session_timeout_seconds));
    }
    changed_.wait_for(lock, kPeriod);
  }
  run_ = session_->run;
  world_edition_ = session_->world_edition;
  stage_ = Stage::kPreparing;
  return std::move(session_);
}

Status AgentHost::MakeReplica(std::unique_ptr<SessionMessage> session) {
  JoinMessage join{.run = session->run,
                   .agent = options_.agent,
                   .protocol_version = kProtocolVersion,
                   .world_hash = Hash(session->world),
                   .host = HostName(),
                   .pid = static_cast<std::uint32_t>(getpid()),
                   .robots = {},
                   .world_edition = session->world_edition};
  replica_.reset();  // first, because the names of its gateway may be those of the next one
  Result<std::unique_ptr<Replica>> replica =
      Replica::Create(std::move(session->world), options_.robots, {scan_log_.get(), options_.libraries},
                      options_.threads, options_.make_gateway, trace_.get());
  if (!replica.ok()) return replica.error();
  const std::lock_guard lock(mutex_);
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
      lock.unlock();  // a send may wait for a delivery, and that for the lock
      endpoint_.SendJoin(join);
      lock.lock();
      // Frequent joins of hundreds of agents before the run begins would delay the service.
      due = Clock::now() + period;
      period = std::min<Clock::duration>(2 * period, kLongestPeriod);
    }
    changed_.wait_for(lock, kPeriod, [this] { return stage_ != Stage::kJoining; });
  }
}

void AgentHost::FollowEdits() {
  std::unique_lock lock(mutex_);
  while (!stopping()) {
    if (stage_ == Stage::kChanging) {
      ChangeReplica(lock);
    } else if (stage_ == Stage::kRunning) {
      changed_.wait_for(lock, kPeriod);
    } else {
      return;
    }
  }
}

void AgentHost::ChangeReplica(std::unique_lock<std::mutex>& lock) {
  const ReplicaChange change = std::exchange(change_, {});
  lock.unlock();
  const Status status = ApplyChange(change);
  lock.lock();
  if (stage_ != Stage::kChanging) return;  // the run ended meanwhile
  if (!status.ok()) {
    return Fail(Failure("the world was edited, and this agent cannot continue: " + status.error().message));
  }
  if (!replica_->has_robots()) {
    stage_ = Stage::kRunOver;
  } else if (change.session && !change.is_member) {
    Fail(Failure("the world was edited while this agent was lost"));
  } else {
    stage_ = Stage::kRunning;
    ProcessKept();
  }
}

Status AgentHost::ApplyChange(const ReplicaChange& change) {
  if (!change.session) return replica_->Renew(change.fresh_edition);
  if (Status status = Validate(change.session->world); !status.ok()) return status;
  return replica_->ChangeWorld(std::move(change.session->world), change.fresh, change.fresh_edition);
}

void AgentHost::OnSession(const SessionMessage& session) {
  const std::lock_guard lock(mutex_);
  const bool chosen = stage_ == Stage::kPreparing || stage_ == Stage::kJoining;
  const bool edited = session.run == run_ && session.world_edition > world_edition_;
  if (stage_ == Stage::kRunning || stage_ == Stage::kChanging) {
    if (!edited || (session_ && session.world_edition <= session_->world_edition)) return;
    session_ = std::make_unique<SessionMessage>(session);
    if (stage_ == Stage::kRunning) ProcessKept();
    return;
  }
  if (chosen ? session.run == run_ && !edited : stage_ != Stage::kWaiting) return;
  // After the choice of a session, this is its world after an edit, or the next run in place of one that ended before
  // it answered.
  session_ = std::make_unique<SessionMessage>(session);
  stage_ = Stage::kWaiting;
  if (!edited) kept_frame_.reset();
  changed_.notify_all();
}

void AgentHost::OnAdmission(const AdmissionMessage& admission) {
  const std::lock_guard lock(mutex_);
  const bool admitted = stage_ == Stage::kRunning || stage_ == Stage::kChanging;
  const bool joined = stage_ == Stage::kJoining || admitted;
  if (!joined || admission.run != run_ || admission.agent != options_.agent) return;
  if (!admission.admitted) return Fail({{}, "the world service refused: " + admission.reason});
  if (admitted) return;
  stage_ = Stage::kRunning;
  changed_.notify_all();
  ProcessKept();
}

void AgentHost::OnFrame(const FrameMessage& frame) {
  const std::lock_guard lock(mutex_);
  const bool admitted = stage_ == Stage::kRunning || stage_ == Stage::kChanging;
  const bool chosen = stage_ == Stage::kPreparing || stage_ == Stage::kJoining || admitted;
  if (!chosen || frame.run != run_) return;
  if (frame.last) {
    stage_ = Stage::kRunOver;
    changed_.notify_all();
  } else if (stage_ == Stage::kRunning) {
    Process(frame);
  } else {
    Keep(frame);
  }
}

void AgentHost::OnServiceGone() {
  const std::lock_guard lock(mutex_);
  if (stage_ == Stage::kRunning || stage_ == Stage::kChanging) {
    Fail(Failure("the world service is gone"));
  } else if (stage_ == Stage::kWaiting || stage_ == Stage::kPreparing || stage_ == Stage::kJoining) {
    // Another service may replace one that left before it answered.
    session_.reset();
    kept_frame_.reset();
    stage_ = Stage::kWaiting;
    changed_.notify_all();
  }
}

void AgentHost::Process(const FrameMessage& frame) {
  if (frame.world_edition < world_edition_ || (answered_ && PlaceOf(frame) < *answered_)) return;
  const bool fresh = fresh_edition_ && frame.fresh_edition > *fresh_edition_;
  if (frame.world_edition == world_edition_ && !fresh) return Answer(frame);
  Keep(frame);
  const bool has_world =
      frame.world_edition == world_edition_ || (session_ && session_->world_edition == frame.world_edition);
  if (has_world) BeginChange(frame, fresh);
}

void AgentHost::BeginChange(const FrameMessage& frame, bool fresh) {
  change_.fresh = fresh;
  change_.fresh_edition = frame.fresh_edition;
  change_.is_member = answered_ && std::get<Edition>(*answered_) + 1 == frame.world_edition;
  if (frame.world_edition != world_edition_) change_.session = std::move(session_);
  world_edition_ = frame.world_edition;
  if (fresh) fresh_edition_ = frame.fresh_edition;
  stage_ = Stage::kChanging;
  changed_.notify_all();
}

void AgentHost::ProcessKept() {
  if (kept_frame_) Process(*std::exchange(kept_frame_, std::nullopt));
}

void AgentHost::Keep(const FrameMessage& frame) {
  if (!kept_frame_ || PlaceOf(frame) > PlaceOf(*kept_frame_)) kept_frame_ = frame;
}

void AgentHost::Answer(const FrameMessage& frame) {
  const FramePlace place = PlaceOf(frame);
  const bool is_new = !answered_ || place > *answered_;
  if (!is_new && !frame.awaited.empty() &&
      std::find(frame.awaited.begin(), frame.awaited.end(), options_.agent) == frame.awaited.end()) {
    return;  // the answer has arrived
  }
  const Tick next = frame.state.tick + 1;
  const bool is_shown = answered_ && IsOneTick(*answered_, place);
  if (is_new && !ComputeAnswer(frame)) return;
  // A paused tick is published first: the answers of all agents mean that every gateway shows the tick.
  if (is_new && frame.paused) replica_->Publish(frame.state);
  Enter(replica_->lane(), TickPhase::kSend, next);
  endpoint_.SendProposal(answer_);
  if (is_new && !is_shown && !frame.paused) replica_->Publish(frame.state);  // last, so that no tick waits for it
  if (!trace_) return;
  trace_->WriteSome();
  Enter(replica_->lane(), TickPhase::kWait, next + 1);
}

bool AgentHost::ComputeAnswer(const FrameMessage& frame) {
  Enter(replica_->lane(), TickPhase::kApply, frame.state.tick + 1);
  if (const Status status = replica_->CheckState(frame.state); !status.ok()) {
    Fail(Failure("the world service sent a bad frame: " + status.error().message));
    return false;
  }
  const bool was_edited = answered_ && std::get<Edition>(*answered_) != frame.edition;
  if (was_edited) replica_->Relocate(frame.state);
  answer_ = frame.paused ? replica_->Pause(frame.state) : replica_->Decide(frame.state);
  answer_.run = run_;
  answer_.agent = options_.agent;
  answer_.edition = frame.edition;
  answered_ = PlaceOf(frame);
  if (!fresh_edition_ && frame.fresh_edition > 0 && scan_log_) scan_log_->Restart(frame.fresh_edition);
  fresh_edition_ = frame.fresh_edition;
  if (scan_log_ && !scan_log_->status().ok()) {
    Fail(AsFailure(scan_log_->status().error()));
    return false;
  }
  return true;
}

void AgentHost::Fail(Error error) {
  stage_ = Stage::kFailed;
  failure_ = std::move(error);
  changed_.notify_all();
}

}  // namespace

Result<AgentEnd> RunAgent(std::unique_ptr<AgentEndpoint> endpoint, const AgentOptions& options,
                          const std::atomic<bool>& stop) {
  AgentHost host(*endpoint, options, stop);
  const std::unique_ptr<AgentEndpoint> ends_first = std::move(endpoint);  // its deliveries end before the host does
  return host.Run();
}

}  // namespace troupe
