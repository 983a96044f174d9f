#include "robot-agent/agent/agent_protocol.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "common/base/identity.h"
#include "common/base/text.h"
#include "common/model/find_robots.h"
#include "robot-agent/robot/robot.h"

namespace troupe {
namespace {

// Wall times, s.
// The period of joins doubles up to this, until the run has begun.
constexpr double kMaxJoinPeriod = 3.2;
// Messages that were sent before a loss of the service arrive within this time after it.
constexpr double kMaxDelay = 1.0;
constexpr double kRepeatPeriod = 0.2;  // in a pause, for new readers of a gateway
constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr std::size_t kMaxReason = 1000;  // bytes, of a refusal

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
  state_ = Waiting{timeout > 0.0 ? now + timeout : kNever};
  // It belongs to a run that is over for this agent.
  run_.kept_frame.reset();
}

void AgentProtocol::Choose(const SessionMessage& session) {
  Run run;
  run.id = session.run;
  run.incarnation = session.incarnation;
  run.newest_world = session.world_edition;
  run.has_begun = session.begun;
  // A newer world of the same run: a frame that has come before it may be answered then.
  if (run_.id == run.id) run.kept_frame = std::move(run_.kept_frame);
  run_ = std::move(run);
  state_ =
      Preparing{std::make_unique<ReplicaTask::Work>(ReplicaTask::Making{std::make_unique<SessionMessage>(session)})};
}

bool AgentProtocol::IsCurrent(Incarnation incarnation) {
  if (incarnation <= run_.incarnation) return incarnation == run_.incarnation;
  run_.incarnation = incarnation;
  if (run_.was_member) {
    run_.service_lost_at.reset();
    notices_.emplace_back("another world service continues the run");
    Rejoin();
  }
  if (Is<Joining>()) state_ = Joining{};
  return true;
}

void AgentProtocol::Rejoin() {
  run_.notes_return = true;
  if (auto* const changing = std::get_if<Changing>(&state_)) changing->rejoins = true;
  if (Is<Running>()) state_ = Joining{};
}

double AgentProtocol::GiveUpAt() const {
  const double timeout = options_.session_timeout_seconds;
  return run_.service_lost_at && timeout > 0.0 ? *run_.service_lost_at + timeout : kNever;
}

double AgentProtocol::NextJoin() const {
  const auto* const joining = std::get_if<Joining>(&state_);
  // Only a joining agent sends joins; the first one is due at once.
  if (joining == nullptr) return kNever;
  if (!joining->sent_at) return -kNever;
  return *joining->sent_at + (run_.has_begun ? kFirstJoinPeriod : joining->period);
}

double AgentProtocol::NextRepeat() const {
  return Is<Running>() && run_.paused_state ? run_.repeated_at + kRepeatPeriod : kNever;
}

double AgentProtocol::NextPoll() const {
  if (const auto* const waiting = std::get_if<Waiting>(&state_)) return waiting->until;
  return std::min({NextJoin(), NextRepeat(), GiveUpAt()});
}

std::optional<JoinMessage> AgentProtocol::Poll(double now) {
  if (const auto* const waiting = std::get_if<Waiting>(&state_); waiting != nullptr && now >= waiting->until) {
    Fail(Failure(fmt::format("no world service appeared within {} s", options_.session_timeout_seconds)));
  }
  if (!over() && now >= GiveUpAt()) {
    Fail(Failure(
        fmt::format("the world service is gone, and has not returned within {} s", options_.session_timeout_seconds)));
  }
  if (now >= NextRepeat()) {
    robots_.replica->Repeat(*run_.paused_state);
    run_.repeated_at = now;
  }
  if (now < NextJoin()) return std::nullopt;
  auto& joining = std::get<Joining>(state_);
  // Frequent joins of hundreds of agents before the run begins would delay the service.
  if (joining.sent_at) joining.period = std::min(2.0 * joining.period, kMaxJoinPeriod);
  joining.sent_at = now;
  // Made at each time: an edit may have come since the last one.
  JoinMessage join = MakeJoin();
  if (!join.robots.empty()) return join;
  state_ = Ended{};
  return std::nullopt;
}

JoinMessage AgentProtocol::MakeJoin() {
  JoinMessage join{.run = run_.id,
                   .agent = options_.agent,
                   .protocol_version = kProtocolVersion,
                   .world_hash = robots_.world_hash,
                   .host = HostName(),
                   .pid = static_cast<std::uint32_t>(getpid()),
                   .robots = robots_.names,
                   .process_robots = {},
                   .world_edition = robots_.world_edition,
                   .incarnation = run_.incarnation,
                   .accept_goals = robots_.replica->NamesThatAcceptGoals(),
                   .memory = robots_.memory};
  if (const SessionMessage* const edited = run_.edited.get()) {
    // The world was edited since the agent was lost. The next frame says how the replica is to follow.
    if (run_.edited_hash == 0) run_.edited_hash = Hash(edited->world);
    join.world_hash = run_.edited_hash;
    join.world_edition = edited->world_edition;
    join.robots = NamesThatExist(edited->world, join.robots);
  }
  if (join.robots.size() < options_.robots.size()) join.process_robots = options_.robots;
  return join;
}

bool AgentProtocol::has_task() const {
  return std::visit(
      [](const auto& state) {
        if constexpr (requires { state.work; }) return state.work != nullptr;
        return false;
      },
      state_);
}

std::optional<ReplicaTask> AgentProtocol::BeginTask() {
  if (!has_task()) return std::nullopt;
  return std::visit(
      [this](auto& state) -> std::optional<ReplicaTask> {
        if constexpr (requires { state.work; }) {
          const Work work = std::move(state.work);
          return ReplicaTask{std::move(*work), std::exchange(robots_, {}), {}};
        }
        return std::nullopt;
      },
      state_);
}

void AgentProtocol::FinishTask(ReplicaTask& task) {
  auto* const past = std::get_if<ReplicaTask::Retracing>(&task.work);
  const bool is_new = std::holds_alternative<ReplicaTask::Making>(task.work);
  // Else the run has ended meanwhile, or another session is to be prepared for.
  const bool is_awaited = is_new ? Is<Preparing>() : past != nullptr ? Is<Retracing>() : Is<Changing>();
  if (!is_awaited || has_task()) return;
  if (!task.outcome.ok()) return Fail(task.outcome.error());
  robots_ = std::move(task.robots);
  if (past != nullptr) return FinishRetracing(*past);
  if (robots_.replica == nullptr || robots_.names.empty()) {
    state_ = Ended{};
    return;
  }
  const auto* const changing = std::get_if<Changing>(&state_);
  if (changing == nullptr || changing->rejoins) {
    state_ = Joining{};
    return;
  }
  state_ = Running{};
  ProcessKept();
}

void AgentProtocol::FinishRetracing(ReplicaTask::Retracing& past) {
  run_.newest_world = std::max(run_.newest_world, robots_.world_edition);
  if (past.later_world && !run_.edited) {
    run_.edited = std::move(past.later_world);
    run_.edited_hash = 0;
  }
  if (run_.edited && run_.edited->world_edition <= robots_.world_edition) run_.edited.reset();
  state_ = Joining{};  // at once, for the states that follow
}

void AgentProtocol::OnSession(const SessionMessage& session) {
  if (over() || (session.run == run_.id && !IsCurrent(session.incarnation))) return;
  const bool is_newer = session.run != run_.id || session.world_edition > run_.newest_world;
  if (!run_.was_member) {
    // After the choice of a session, this may be its world after an edit, or the next run in place of one that ended
    // before it answered.
    if (Is<Waiting>() || is_newer) Choose(session);
    return;
  }
  if (session.run != run_.id) return;
  if (std::exchange(run_.service_lost_at, std::nullopt) && Is<Joining>()) state_ = Joining{};
  if (!is_newer) return;
  run_.newest_world = session.world_edition;
  run_.edited = std::make_unique<SessionMessage>(session);
  run_.edited_hash = 0;
  if (Is<Running>()) ProcessKept();
}

void AgentProtocol::OnAdmission(const AdmissionMessage& admission) {
  if (over() || admission.run != run_.id || admission.agent != options_.agent) return;
  if (!IsCurrent(admission.incarnation)) return;
  if (Is<Running>() && !admission.admitted && admission.reason.empty()) return Rejoin();
  if (!Is<Joining>()) return;
  if (!admission.admitted) {
    if (!admission.reason.empty()) OnRefusal(admission);
    return;
  }
  run_.was_member = true;
  if (std::exchange(run_.notes_return, false)) notices_.emplace_back("joined the run again");
  state_ = Running{};
  ProcessKept();
}

void AgentProtocol::OnRefusal(const AdmissionMessage& admission) {
  // Whoever starts the first agents of a run chooses their robots; later a robot that was deleted and has returned may
  // have got another agent while the earlier one was dead or lost.
  const bool may_leave = (options_.skip_unavailable || run_.was_member) && !admission.taken.empty();
  if (!may_leave) return Fail({{}, "the world service refused: " + PlainLine(admission.reason, kMaxReason)});
  std::set<std::string> left;
  for (const std::string& name : admission.taken) {
    if (std::find(robots_.names.begin(), robots_.names.end(), name) != robots_.names.end()) left.insert(name);
  }
  if (left.empty()) return;  // a late answer
  notices_.push_back(left.size() == 1 ? fmt::format("{} has another agent now", *left.begin())
                                      : fmt::format("{} of its robots have other agents now", left.size()));
  state_ = Changing{std::make_unique<ReplicaTask::Work>(ReplicaTask::Leaving{std::move(left)}), true};
}

void AgentProtocol::OnFrame(const FrameMessage& frame, double now, bool is_checked) {
  if (over() || Is<Waiting>() || frame.run != run_.id || !IsCurrent(frame.incarnation)) return;
  run_.has_begun = true;
  run_.received_at = now;
  if (run_.service_lost_at && now > *run_.service_lost_at + kMaxDelay) run_.service_lost_at.reset();
  if (frame.last) {
    state_ = Ended{};
  } else if (Is<Running>()) {
    Process(frame, is_checked);
  } else {
    Keep(frame);
  }
}

void AgentProtocol::OnHistory(const HistoryMessage& history) {
  if (!Is<Joining>() || history.run != run_.id || !IsCurrent(history.incarnation)) return;
  if (history.after != robots_.memory) return;
  const bool asked = std::find(history.agents.begin(), history.agents.end(), options_.agent) != history.agents.end();
  if (!asked && !robots_.memory) return;  // it may begin behind the first state of these robots
  run_.has_begun = true;                  // the service has work for joins: resend them often
  state_ =
      Retracing{std::make_unique<ReplicaTask::Work>(ReplicaTask::Retracing{std::make_unique<HistoryMessage>(history)})};
}

void AgentProtocol::OnServiceGone(double now) {
  if (over()) return;
  if (!run_.was_member) return WaitForSession(now);  // another service may replace one that left before it answered
  state_ = Ended{};                                  // its last frame is lost
}

void AgentProtocol::OnServiceLost(double now) {
  if (over()) return;
  if (!run_.was_member) return WaitForSession(now);
  notices_.emplace_back("the world service is silent; waiting for it to return");
  run_.service_lost_at = now;
  Rejoin();
}

void AgentProtocol::Process(const FrameMessage& frame, bool is_checked) {
  const FramePlace place = PlaceOf(frame);
  if (frame.world_edition < robots_.world_edition || (run_.answered && place < *run_.answered)) return;
  // Robots that have not answered a frame yet are as new, but the ids may have changed since their world.
  // The session message with the new world may come before this frame or after it: the frame is kept until the world is
  // there.
  const bool is_new_world = frame.world_edition != robots_.world_edition;
  const bool fresh = robots_.fresh_edition ? frame.fresh_edition > *robots_.fresh_edition
                                           : is_new_world && frame.fresh_edition > robots_.world_edition;
  if (!is_new_world && !fresh) return place == run_.answered ? AnswerAgain(frame) : AnswerNew(frame, is_checked);
  Keep(frame);
  if (is_new_world && (!run_.edited || run_.edited->world_edition != frame.world_edition)) return;
  ReplicaTask::Changing change{.session = {}, .fresh = fresh, .fresh_edition = frame.fresh_edition};
  if (is_new_world) change.session = std::move(run_.edited);
  state_ = Changing{std::make_unique<ReplicaTask::Work>(std::move(change))};
}

void AgentProtocol::ProcessKept() {
  if (run_.kept_frame) Process(*std::exchange(run_.kept_frame, std::nullopt), false);
}

void AgentProtocol::Keep(const FrameMessage& frame) {
  if (!run_.kept_frame || PlaceOf(frame) > PlaceOf(*run_.kept_frame)) run_.kept_frame = frame;
}

void AgentProtocol::AnswerAgain(const FrameMessage& frame) {
  const bool is_awaited = frame.awaited.empty() ||
                          std::find(frame.awaited.begin(), frame.awaited.end(), options_.agent) != frame.awaited.end();
  if (!is_awaited) return;  // the answer has arrived
  SendAnswer(frame.state.tick + 1);
  WriteTrace(frame.state.tick + 1);
}

void AgentProtocol::AnswerNew(const FrameMessage& frame, bool is_checked) {
  if (LacksMemory(frame)) {
    Keep(frame);
    run_.asked_memory_of = frame.fresh_edition;
    state_ = Joining{};
    return;
  }
  // A tick that was published in a pause is not published again.
  const bool is_shown = run_.answered && std::get<Edition>(*run_.answered) == frame.edition &&
                        std::get<Tick>(*run_.answered) == frame.state.tick;
  if (!ComputeAnswer(frame, is_checked)) return;
  // A paused tick is published first: the answers of all agents mean that every gateway shows the tick.
  run_.paused_state.reset();
  if (frame.paused) {
    robots_.replica->Publish(frame.state);
    robots_.replica->AwaitPublished();
    if (robots_.replica->has_gateway()) run_.paused_state = frame.state;
    // Not in the short pause of a tick that waits for nodes: they would see it twice.
    run_.repeated_at = std::max(run_.repeated_at, run_.received_at);
  }
  SendAnswer(frame.state.tick + 1);
  if (!is_shown && !frame.paused) robots_.replica->Publish(frame.state);  // last, so that no tick waits for it
  WriteTrace(frame.state.tick + 1);
}

void AgentProtocol::SendAnswer(Tick next) {
  // The answer may be shared with the service in this process, and must not change: a copy is sent.
  if (run_.answer->incarnation != run_.incarnation) {  // the service has seen another message
    auto renewed = std::make_shared<ProposalMessage>(*run_.answer);
    renewed->incarnation = run_.incarnation;
    run_.answer = std::move(renewed);
  }
  Enter(robots_.replica->lane(), TickPhase::kSend, next);
  endpoint_.SendSharedProposal(run_.answer);
}

// Only this agent may add a user of an answer, so that one without another user keeps none.
std::vector<Proposal> AgentProtocol::TakeUnusedProposals() {
  const std::shared_ptr<ProposalMessage> unused =
      std::const_pointer_cast<ProposalMessage>(std::exchange(run_.earlier_answer, run_.answer));
  if (unused == nullptr || unused.use_count() != 1) return {};
  std::atomic_thread_fence(std::memory_order_acquire);  // its last user may have been another thread
  return std::move(unused->proposals);
}

void AgentProtocol::WriteTrace(Tick next) {
  if (resources_.trace == nullptr) return;
  if (const Status& status = resources_.trace->WriteSome(); !status.ok()) return Fail(status.error());
  Enter(robots_.replica->lane(), TickPhase::kWait, next + 1);
}

bool AgentProtocol::LacksMemory(const FrameMessage& frame) const {
  const bool knows = robots_.memory && robots_.memory->edition >= frame.fresh_edition;
  return frame.remembered && !knows && run_.asked_memory_of != frame.fresh_edition;
}

bool AgentProtocol::ComputeAnswer(const FrameMessage& frame, bool is_checked) {
  Replica& replica = *robots_.replica;
  Enter(replica.lane(), TickPhase::kApply, frame.state.tick + 1);
  if (const Status status = is_checked ? Status() : replica.CheckState(frame.state); !status.ok()) {
    // Not more than one line for a frame that is resent. Without an answer, the service loses this agent in the end.
    if (std::exchange(run_.bad_frame, PlaceOf(frame)) != PlaceOf(frame)) {
      notices_.push_back("ignored a bad frame of the world service: " + status.error().message);
    }
    return false;
  }
  const bool was_edited = robots_.memory && robots_.memory->edition != frame.edition;
  // Before the decision: odometry must not count the jump of an edit as a motion.
  if (was_edited) replica.Relocate(frame.state);
  auto answer = std::make_shared<ProposalMessage>(
      frame.paused ? replica.Pause(frame.state) : replica.Decide(frame.state, frame.commands, TakeUnusedProposals()));
  answer->run = run_.id;
  answer->agent = options_.agent;
  answer->edition = frame.edition;
  answer->incarnation = run_.incarnation;
  run_.answer = std::move(answer);
  run_.answered = PlaceOf(frame);
  // From now on the robots have processed this state.
  robots_.memory = {frame.edition, frame.state.tick, !frame.paused};
  ScanLog* const log = resources_.scan_log;
  if (!std::exchange(robots_.log_is_marked, true) && frame.fresh_edition > 0 && log != nullptr) {
    log->Restart(frame.fresh_edition);
  }
  robots_.fresh_edition = frame.fresh_edition;
  if (log != nullptr && !log->status().ok()) {
    Fail(AsFailure(log->status().error()));
    return false;
  }
  return true;
}

}  // namespace troupe
