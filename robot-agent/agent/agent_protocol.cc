#include "robot-agent/agent/agent_protocol.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#include "common/base/host_name.h"
#include "common/base/utf8.h"
#include "common/base/version.h"
#include "robot-agent/robot/scan_log.h"

namespace troupe {
namespace {

// Wall times, s.
constexpr double kJoinPeriod = 0.1;  // from a join without an answer to the next one, at first
// The period doubles up to this, until the run has begun.
constexpr double kLongestJoinPeriod = 3.2;
// Messages that were sent before a loss of the service arrive within this time after it.
constexpr double kLongestDelay = 1.0;
constexpr double kRepeatPeriod = 0.2;  // in a pause, for new readers of a gateway
constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr std::size_t kLongestReason = 1000;  // bytes, of a refusal

// With the code of a failure: the caller cannot correct it.
Error AsFailure(Error error) {
  if (error.code == ErrorCode::kBadInput) error.code = ErrorCode::kFailure;
  return error;
}

}  // namespace

AgentProtocol::AgentProtocol(AgentEndpoint& endpoint, const AgentOptions& options, const AgentResources& resources,
                             double now)
    : endpoint_(endpoint), options_(options), resources_(resources) {
  WaitForSession(now);
}

void AgentProtocol::WaitForSession(double now) {
  const double timeout = options_.session_timeout_seconds;
  stage_ = Stage::kWaiting;
  waiting_until_ = timeout > 0.0 ? now + timeout : kNever;
  session_.reset();
  kept_frame_.reset();
}

void AgentProtocol::Choose(const SessionMessage& session) {
  if (session.run != run_) kept_frame_.reset();
  session_ = std::make_unique<SessionMessage>(session);
  run_ = session.run;
  incarnation_ = session.incarnation;
  world_edition_ = session.world_edition;
  run_has_begun_ = session.begun;
  stage_ = Stage::kPreparing;
}

bool AgentProtocol::IsCurrent(Incarnation incarnation) {
  if (incarnation <= incarnation_) return incarnation == incarnation_;
  incarnation_ = incarnation;
  if (was_admitted()) {
    service_lost_at_.reset();
    notices_.emplace_back("another world service continues the run");
    Rejoin();
  }
  if (stage_ == Stage::kJoining) StartJoining();
  return true;
}

void AgentProtocol::StartJoining() {
  stage_ = Stage::kJoining;
  joined_at_ = -kNever;
  join_period_ = kJoinPeriod;
}

void AgentProtocol::Rejoin() {
  was_lost_ = true;
  tells_return_ = true;
  if (stage_ == Stage::kRunning) StartJoining();
}

double AgentProtocol::GiveUpAt() const {
  const double timeout = options_.session_timeout_seconds;
  return service_lost_at_ && timeout > 0.0 ? *service_lost_at_ + timeout : kNever;
}

double AgentProtocol::NextJoin() const {
  return joined_at_ + (run_has_begun_ ? kJoinPeriod : join_period_);
}

std::optional<JoinMessage> AgentProtocol::Poll(double now) {
  if (stage_ == Stage::kWaiting && now >= waiting_until_) {
    Fail(Failure(fmt::format("no world service appeared within {} s", options_.session_timeout_seconds)));
  }
  if (!over() && now >= GiveUpAt()) {
    Fail(Failure(
        fmt::format("the world service is gone, and has not returned within {} s", options_.session_timeout_seconds)));
  }
  if (Replica* const replica = replica_.get(); replica != nullptr && now >= NextRepeat()) {
    replica->Repeat(*paused_state_);
    repeated_at_ = now;
  }
  if (stage_ != Stage::kJoining || now < NextJoin()) return std::nullopt;
  // Frequent joins of hundreds of agents before the run begins would delay the service.
  if (joined_at_ > -kNever) join_period_ = std::min(2.0 * join_period_, kLongestJoinPeriod);
  joined_at_ = now;
  JoinMessage join = MakeJoin();
  if (join.robots.empty()) {
    stage_ = Stage::kRunOver;
    return std::nullopt;
  }
  return join;
}

double AgentProtocol::NextPoll() const {
  if (stage_ == Stage::kWaiting) return waiting_until_;
  return std::min({stage_ == Stage::kJoining ? NextJoin() : kNever, NextRepeat(), GiveUpAt()});
}

double AgentProtocol::NextRepeat() const {
  return stage_ == Stage::kRunning && paused_state_ ? repeated_at_ + kRepeatPeriod : kNever;
}

JoinMessage AgentProtocol::MakeJoin() {
  JoinMessage join{.run = run_,
                   .agent = options_.agent,
                   .protocol_version = kProtocolVersion,
                   .world_hash = world_hash_,
                   .host = HostName(),
                   .pid = static_cast<std::uint32_t>(getpid()),
                   .robots = robots_,
                   .world_edition = world_edition_,
                   .incarnation = incarnation_,
                   .accept_goals = replica_->NamesThatAcceptGoals(),
                   .memory = memory_};
  if (session_) {
    // The world was edited since the agent was lost. The next frame says how the replica is to follow.
    if (session_hash_ == 0) session_hash_ = Hash(session_->world);
    join.world_hash = session_hash_;
    join.world_edition = session_->world_edition;
    std::erase_if(join.robots, [this](const std::string& name) { return !FindRobot(session_->world, name); });
  }
  return join;
}

bool AgentProtocol::has_task() const {
  const bool works_on_replica = stage_ == Stage::kChanging || stage_ == Stage::kRetracing;
  return (stage_ == Stage::kPreparing && session_ != nullptr) || (works_on_replica && replica_ != nullptr);
}

std::optional<ReplicaTask> AgentProtocol::BeginTask() {
  if (!has_task()) return std::nullopt;
  ReplicaTask task;
  if (stage_ == Stage::kChanging) {
    task = std::exchange(change_, {});
  } else if (stage_ == Stage::kRetracing) {
    task.history = std::move(history_);
    task.own_robots = robots_;
    task.world_edition = world_edition_;
    task.world_hash = world_hash_;
    task.made_at = fresh_edition_;
    task.memory = memory_;
  } else {
    task.is_new = true;
    task.session = std::move(session_);
  }
  task.replica = std::move(replica_);
  return task;
}

void AgentProtocol::FinishTask(ReplicaTask& task) {
  // Else the run has ended meanwhile, or another session is to be prepared for.
  if (task.is_new && stage_ == Stage::kPreparing && session_ == nullptr) FinishMaking(task);
  if (task.is_new) return;
  if (task.history && stage_ == Stage::kRetracing) return FinishRetracing(task);
  if (!task.history && stage_ == Stage::kChanging) FinishChange(task);
}

void AgentProtocol::FinishMaking(ReplicaTask& task) {
  if (!task.outcome.ok()) return Fail(task.outcome.error());
  if (task.replica == nullptr) {
    stage_ = Stage::kRunOver;
    return;
  }
  replica_ = std::move(task.replica);
  world_hash_ = task.world_hash;
  robots_ = replica_->RobotNames();
  answered_.reset();
  fresh_edition_.reset();
  memory_.reset();
  remembered_.reset();
  log_is_marked_ = false;
  StartJoining();
}

void AgentProtocol::FinishChange(ReplicaTask& task) {
  if (!task.outcome.ok()) return Fail(task.outcome.error());
  replica_ = std::move(task.replica);
  if (task.session) world_hash_ = task.world_hash;
  robots_ = replica_->RobotNames();
  if (!replica_->has_robots()) {
    stage_ = Stage::kRunOver;
    return;
  }
  stage_ = Stage::kRunning;
  if (was_lost_) return StartJoining();
  ProcessKept();
}

void AgentProtocol::FinishRetracing(ReplicaTask& task) {
  if (!task.outcome.ok()) return Fail(task.outcome.error());
  replica_ = std::move(task.replica);
  world_hash_ = task.world_hash;
  world_edition_ = task.world_edition;
  fresh_edition_ = task.made_at;
  memory_ = task.memory;
  if (task.put_aside && !session_) {
    session_ = std::move(task.put_aside);
    session_hash_ = 0;
  }
  if (session_ && session_->world_edition <= world_edition_) session_.reset();
  StartJoining();  // at once, for the states that follow
}

void AgentProtocol::OnSession(const SessionMessage& session) {
  if (over() || (session.run == run_ && !IsCurrent(session.incarnation))) return;
  if (was_admitted()) {
    if (session.run != run_) return;
    if (std::exchange(service_lost_at_, std::nullopt) && stage_ == Stage::kJoining) StartJoining();
    if (session.world_edition <= (session_ ? session_->world_edition : world_edition_)) return;
    session_ = std::make_unique<SessionMessage>(session);
    session_hash_ = 0;
    if (stage_ == Stage::kRunning) ProcessKept();
    return;
  }
  // After the choice of a session, this may be its world after an edit, or the next run in place of one that ended
  // before it answered.
  const Edition known = session_ ? session_->world_edition : world_edition_;
  if (stage_ != Stage::kWaiting && session.run == run_ && session.world_edition <= known) return;
  Choose(session);
}

void AgentProtocol::OnAdmission(const AdmissionMessage& admission) {
  if (admission.run != run_ || admission.agent != options_.agent || !IsCurrent(admission.incarnation)) return;
  if (stage_ == Stage::kRunning && !admission.admitted && admission.reason.empty()) return Rejoin();
  if (stage_ != Stage::kJoining) return;
  if (!admission.admitted) {
    if (!admission.reason.empty())
      Fail({{}, "the world service refused: " + PlainLine(admission.reason, kLongestReason)});
    return;
  }
  was_lost_ = false;
  if (std::exchange(tells_return_, false)) notices_.emplace_back("joined the run again");
  stage_ = Stage::kRunning;
  ProcessKept();
}

void AgentProtocol::OnFrame(const FrameMessage& frame, double now) {
  if (over() || stage_ == Stage::kWaiting || frame.run != run_ || !IsCurrent(frame.incarnation)) return;
  run_has_begun_ = true;
  if (service_lost_at_ && now > *service_lost_at_ + kLongestDelay) service_lost_at_.reset();
  if (frame.last) {
    stage_ = Stage::kRunOver;
  } else if (stage_ == Stage::kRunning) {
    Process(frame);
  } else {
    Keep(frame);
  }
}

void AgentProtocol::OnHistory(const HistoryMessage& history) {
  if (stage_ != Stage::kJoining || history.run != run_ || !IsCurrent(history.incarnation)) return;
  if (history.after != memory_) return;
  const bool asked = std::find(history.agents.begin(), history.agents.end(), options_.agent) != history.agents.end();
  if (!asked && !memory_) return;  // it may begin behind the first state of these robots
  run_has_begun_ = true;           // the service has work for joins: resend them often
  history_ = std::make_unique<HistoryMessage>(history);
  stage_ = Stage::kRetracing;
}

void AgentProtocol::OnServiceGone(double now) {
  if (over()) return;
  if (was_admitted()) return Fail(Failure("the world service is gone"));
  WaitForSession(now);  // another service may replace one that left before it answered
}

void AgentProtocol::OnServiceLost(double now) {
  if (over()) return;
  if (!was_admitted()) return WaitForSession(now);
  notices_.emplace_back("the world service is silent; waiting for it to return");
  service_lost_at_ = now;
  Rejoin();
}

void AgentProtocol::Process(const FrameMessage& frame) {
  if (frame.world_edition < world_edition_ || (answered_ && PlaceOf(frame) < *answered_)) return;
  // Robots that have not answered a frame yet are as new, but the ids may have changed since their world.
  const bool is_new_world = frame.world_edition != world_edition_;
  const bool fresh =
      fresh_edition_ ? frame.fresh_edition > *fresh_edition_ : is_new_world && frame.fresh_edition > world_edition_;
  if (!is_new_world && !fresh) return Answer(frame);
  Keep(frame);
  if (!is_new_world || (session_ && session_->world_edition == frame.world_edition)) BeginChange(frame, fresh);
}

void AgentProtocol::BeginChange(const FrameMessage& frame, bool fresh) {
  change_.fresh = fresh;
  change_.fresh_edition = frame.fresh_edition;
  if (frame.world_edition != world_edition_) change_.session = std::move(session_);
  world_edition_ = frame.world_edition;
  if (fresh) {
    fresh_edition_ = frame.fresh_edition;
    memory_.reset();
    log_is_marked_ = true;  // by the change
  }
  stage_ = Stage::kChanging;
}

void AgentProtocol::ProcessKept() {
  if (kept_frame_) Process(*std::exchange(kept_frame_, std::nullopt));
}

void AgentProtocol::Keep(const FrameMessage& frame) {
  if (!kept_frame_ || PlaceOf(frame) > PlaceOf(*kept_frame_)) kept_frame_ = frame;
}

void AgentProtocol::Answer(const FrameMessage& frame) {
  const FramePlace place = PlaceOf(frame);
  const bool is_new = !answered_ || place > *answered_;
  if (!is_new && !frame.awaited.empty() &&
      std::find(frame.awaited.begin(), frame.awaited.end(), options_.agent) == frame.awaited.end()) {
    return;  // the answer has arrived
  }
  const Tick next = frame.state.tick + 1;
  // A tick that was published in a pause is not published again.
  const bool is_shown =
      answered_ && std::get<Edition>(*answered_) == frame.edition && std::get<Tick>(*answered_) == frame.state.tick;
  if (is_new && LacksMemory(frame)) {
    Keep(frame);
    remembered_ = frame.fresh_edition;
    was_lost_ = true;
    return StartJoining();
  }
  if (is_new && !ComputeAnswer(frame)) return;
  // A paused tick is published first: the answers of all agents mean that every gateway shows the tick.
  if (is_new) paused_state_.reset();
  if (is_new && frame.paused) {
    replica_->Publish(frame.state);
    if (replica_->has_gateway()) paused_state_ = frame.state;
  }
  answer_.incarnation = incarnation_;
  Enter(replica_->lane(), TickPhase::kSend, next);
  endpoint_.SendProposal(answer_);
  if (is_new && !is_shown && !frame.paused) replica_->Publish(frame.state);  // last, so that no tick waits for it
  if (resources_.trace == nullptr) return;
  if (const Status& status = resources_.trace->WriteSome(); !status.ok()) return Fail(status.error());
  Enter(replica_->lane(), TickPhase::kWait, next + 1);
}

bool AgentProtocol::LacksMemory(const FrameMessage& frame) const {
  const bool knows = memory_ && memory_->edition >= frame.fresh_edition;
  return frame.remembered && !knows && remembered_ != frame.fresh_edition;
}

bool AgentProtocol::ComputeAnswer(const FrameMessage& frame) {
  Enter(replica_->lane(), TickPhase::kApply, frame.state.tick + 1);
  if (const Status status = replica_->CheckState(frame.state); !status.ok()) {
    Fail(Failure("the world service sent a bad frame: " + status.error().message));
    return false;
  }
  const bool was_edited = memory_ && memory_->edition != frame.edition;
  if (was_edited) replica_->Relocate(frame.state);
  answer_ = frame.paused ? replica_->Pause(frame.state) : replica_->Decide(frame.state, frame.commands);
  answer_.run = run_;
  answer_.agent = options_.agent;
  answer_.edition = frame.edition;
  answered_ = PlaceOf(frame);
  memory_ = {frame.edition, frame.state.tick, !frame.paused};
  ScanLog* const log = resources_.scan_log;
  if (!std::exchange(log_is_marked_, true) && frame.fresh_edition > 0 && log != nullptr) {
    log->Restart(frame.fresh_edition);
  }
  fresh_edition_ = frame.fresh_edition;
  if (log != nullptr && !log->status().ok()) {
    Fail(AsFailure(log->status().error()));
    return false;
  }
  return true;
}

void AgentProtocol::Fail(Error error) {
  stage_ = Stage::kFailed;
  failure_ = std::move(error);
}

}  // namespace troupe
