#include "world-service/service/tick_engine.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/or_failure.h"
#include "common/model/states.h"
#include "common/spatial/check_order.h"

namespace troupe {
namespace {

// Wall times, s.
constexpr double kFirstResendOfLast = 0.02;  // of the last frame: agents that missed it delay the end
constexpr double kMaxEnd = 1.0;              // for agents to leave
constexpr double kAskPeriod = 0.1;           // from one request to an agent to join again to the next
constexpr double kFirstAnswers = 5.0;        // of silence after the first frame, until a notice
constexpr double kHaltedResend = 0.5;        // of the frame, while the run waits for lost agents
constexpr double kLatencySmoothing = 0.1;    // its share in the smoothed time of an agent's answers
constexpr double kNever = std::numeric_limits<double>::infinity();

std::optional<double> SpeedOf(const RunSettings& settings) {
  if (settings.mode == Mode::kRealtime) return settings.pace().value_or(1.0);
  return settings.pace();
}

// Without zeros at the end.
std::string SpeedText(double speed) {
  std::string text = std::to_string(speed);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

// The number of the last goal, for a service that continues a run. Robots tell a new goal from the present one by its
// number, and this service does not know how many goals the one before gave out: the golden-ratio multiplier spreads
// the start of the numbers over 32 bits, so that it is improbable that one repeats.
std::uint32_t LastGoalBefore(const ResumedRun& resumed) {
  return static_cast<std::uint32_t>((resumed.next_number + 1) * 0x9E3779B1U + resumed.incarnation);
}

// The state that a proposal is for.
StatePlace PlaceOf(const ProposalMessage& proposal) {
  return {proposal.edition, proposal.tick};
}

// Calls all observers; the outcome is the first that is not a success.
template <typename Call>
Status CallObservers(const RunObservers& observers, const Call& call) {
  Status first;
  for (RunObserver* observer : observers) {
    const Status outcome = OrFailure([&] { return call(*observer); });
    if (first.ok()) first = outcome;
  }
  return first;
}

}  // namespace

TickEngine::TickEngine(LiveRun& run, double now)
    : run_(run),
      stepper_(std::make_unique<Stepper>(*run.scene, run.options.pool)),
      proposals_(*run.scene, run.options.settings.mode),
      pacer_(SpeedOf(run.options.settings), run.world().interval_seconds()),
      resend_timer_(run.endpoint.may_lose_messages() ? run.options.settings.agent_deadline_seconds : 0.0),
      committed_at_(now),
      arrived_at_(now) {
  if (run_.options.start_paused) ticks_to_pause_ = 0;
  if (run_.continues()) {
    const ResumedRun& resumed = *run_.options.resumed;
    commands_ = RobotCommands(LastGoalBefore(resumed));
    commands_.Restore(resumed.progress.commands);
    inputs_ = resumed.progress.inputs;
    DropInvalidInputs();
    // A speed that a tool has set outlives the service; that of the command line is in the settings already.
    if (resumed.progress.speed_is_set) SetSpeed(resumed.progress.speed, now);
    run_.frame = *resumed.frame;
    run_.memories.Resume(resumed.previous, run_.frame.fresh_edition);
    // The service before may have ended within a rewind.
    run_.restoring = run_.frame.remembered = run_.options.has_history && resumed.previous.has_value() &&
                                             !run_.memories.IsFirstOf(run_.frame.fresh_edition, run_.frame);
    ticks_to_pause_ = resumed.progress.ticks_to_pause;
    run_.frame.paused = ticks_to_pause_ == 0U;
    run_.events.RestoreCounts(resumed.progress.stalls, resumed.progress.rejected);
  } else {
    run_.frame.state = InitialState(*run_.scene);
    run_.frame.state_hash = StateHash(run_.frame.state);
  }
  run_.frame.run = run_.options.run;
  run_.frame.incarnation = run_.options.incarnation;
}

void TickEngine::AddMember(Member& member, double now) {
  member.silent_since = now;
  barrier_.AddMember(member.id);
  if (run_.is_branch() && run_.phase == RunPhase::kGathering) return;  // no event of the tick that it begins with
  for (RobotId robot : member.robots) {
    run_.events.Add(EventType::kJoined, run_.frame.state.tick, robot, Describe(member));
  }
}

void TickEngine::OnProposal(const ProposalMessage& proposal, double now, const SharedProposal& shared) {
  if (run_.phase != RunPhase::kRunning) return;
  const FrameMessage& frame = run_.frame;
  if (proposal.run != run_.options.run) return Reject("a proposal for another run", now);
  if (proposal.incarnation != run_.options.incarnation) return;  // the agent has not seen this service yet
  Member* const member = run_.members.Find(proposal.agent);
  if (member == nullptr) return RejectUnknown(proposal.agent, now);
  if (proposal.edition < frame.edition) return;  // of the world before an edit
  if (proposal.edition > frame.edition) {
    return Reject("a proposal of " + Describe(*member) + " for edition " + std::to_string(proposal.edition) +
                      ", expected " + std::to_string(frame.edition),
                  now);
  }
  if (proposal.tick > run_.next_tick()) {
    return Reject("a proposal of " + Describe(*member) + " for tick " + std::to_string(proposal.tick) + ", expected " +
                      std::to_string(run_.next_tick()),
                  now);
  }
  if (proposal.tick < run_.next_tick()) {
    // Usually the answer to a resent frame. In realtime mode it may be new, and is the robot's last command.
    const bool late = run_.realtime() && proposal.tick == frame.state.tick && PlaceOf(proposal) > member->last_answered;
    if (late && member->present) Collect(*member, proposal, now, shared);
    return;
  }
  if (proposal.paused != frame.paused) return;  // answers the frame as it was before
  if (!member->present) {
    // A proposal may arrive after its agent was reported lost, but a join is sent later than that: only a join proves
    // that the agent lives.
    if (member->gone) return AskToJoin(*member, now);
    run_.members.Restore(*member);
    AddMember(*member, now);
  }
  // The first message for a tick counts; a repetition has the same content, or its sender is at fault.
  if (!barrier_.Arrive(proposal.agent)) return resend_timer_.AnsweredTwice();
  if (barrier_.complete()) first_answers_ = FirstAnswers::kComplete;
  if (proposal.paused) {
    member->silent_since.reset();
    resend_timer_.Answered(now);
    arrived_at_ = now;
    return AdvanceRelease(now);
  }
  Collect(*member, proposal, now, shared);
  const double answer = now - committed_at_;
  double& smoothed = member->answer_seconds;
  // The first answer counts as a whole: an average from zero would show the agent as fast for its first ticks.
  smoothed = smoothed == 0.0 ? answer : smoothed + kLatencySmoothing * (answer - smoothed);
  if (barrier_.complete()) {
    // This agent was awaited alone, from the answer before it on.
    ++member->times_last;
    member->waited_seconds += now - arrived_at_;
  }
  arrived_at_ = now;
  resend_timer_.Answered(now);
  if (ReadyToCommit(now)) Commit(now);
}

void TickEngine::Collect(Member& member, const ProposalMessage& message, double now, const SharedProposal& shared) {
  member.last_answered = PlaceOf(message);
  member.silent_since.reset();
  for (const Rejection& rejection : proposals_.Collect(member, message, run_.frame.state, shared)) {
    run_.events.Reject(run_.frame.state.tick, rejection.robot, rejection.reason, now);
  }
  for (const std::string& report : message.reports) Report(member, report);
}

// Reports are lines that begin with the name of their robot, if they have one.
void TickEngine::Report(const Member& member, std::string_view report) {
  std::optional<RobotId> robot;
  std::string_view text = report;
  for (const RobotId id : member.robots) {
    const std::string prefix = "robot " + run_.world().robot(id).name + ": ";
    // The longest matching name: the name of one robot may begin with that of another one and ": ".
    if (!report.starts_with(prefix) || report.size() - prefix.size() > text.size()) continue;
    robot = id;
    text = report.substr(prefix.size());
  }
  const Tick tick = run_.frame.state.tick;
  if (robot) return run_.events.Report(tick, robot, text);
  run_.events.Report(tick, robot, Describe(member) + ": " + std::string(report));
}

void TickEngine::Reject(std::string reason, double now) {
  run_.events.Reject(run_.frame.state.tick, std::nullopt, std::move(reason), now);
}

// An agent that was lost when the world was edited, or that another one has replaced, does not know it.
void TickEngine::RejectUnknown(AgentId agent, double now) {
  const bool reported =
      run_.events.Reject(run_.frame.state.tick, std::nullopt, "a proposal of an agent that has not joined", now);
  if (!reported) return;  // of many, not all are answered
  run_.endpoint.SendAdmissions({MakeAdmission(run_, agent, false)});
}

void TickEngine::AskToJoin(Member& member, double now) {
  if (now - member.asked_at < kAskPeriod) return;
  member.asked_at = now;
  run_.endpoint.SendAdmissions({MakeAdmission(run_, member.id, false)});
}

void TickEngine::OnAgentGone(AgentId agent, double now) {
  Member* const member = run_.members.Find(agent);
  if (member == nullptr) return;
  member->gone = true;
  if (member->present) Lose(*member, "it ended, or its lease ran out", now);
}

void TickEngine::Lose(Member& member, const std::string& reason, double now) {
  run_.members.Lose(member);
  barrier_.RemoveMember(member.id);
  const bool none_left = run_.members.present_members() == 0;
  if (none_left) halted_since_ = now;
  if (run_.phase == RunPhase::kEnding) {
    if (none_left) run_.phase = RunPhase::kOver;
    return;
  }
  for (RobotId robot : member.robots) {
    run_.events.Add(EventType::kLeft, run_.frame.state.tick, robot, Describe(member) + ": " + reason);
  }
  if (run_.phase != RunPhase::kRunning) return;
  if (run_.options.settings.on_agent_loss == OnAgentLoss::kAbort) {
    return Fail(Failure("the agent of " + ListNames(run_.world(), member.robots) + " (" + Describe(member) +
                        ") is lost: " + reason),
                now);
  }
  if (ReadyToCommit(now)) Commit(now);
}

void TickEngine::LoseSilentMembers(double now) {
  const double deadline = run_.options.settings.agent_deadline_seconds;
  if (run_.phase != RunPhase::kRunning || barrier_.complete()) return;
  // Before the first answers a silent agent says nothing about itself: the network may drop the frames to its host.
  if (first_answers_ != FirstAnswers::kComplete && !run_.realtime() && !run_.takes_over())
    return AwaitFirstAnswers(now);
  if (deadline <= 0.0) return;
  for (AgentId agent : barrier_.Missing()) {
    Member* const member = run_.members.Find(agent);
    double heard_at = member->silent_since.value_or(committed_at_);
    // Over a slow link the answers come one after another: the missing ones are still under way.
    if (!run_.realtime()) heard_at = std::max(heard_at, arrived_at_);
    const double silent = now - heard_at;
    if (silent < deadline) continue;
    Lose(*member, "it was silent for " + std::to_string(static_cast<int>(silent)) + " s", now);
    if (run_.phase != RunPhase::kRunning) return;
  }
}

// A network that does not pass the frames on to all hosts loses no agent: the run has not begun for those.
void TickEngine::AwaitFirstAnswers(double now) {
  const double waited = now - arrived_at_;
  const double timeout = run_.options.start_timeout_seconds;
  const bool is_over = run_.options.settings.agent_deadline_seconds > 0.0 && timeout > 0.0 && waited >= timeout;
  if (!is_over && (waited < kFirstAnswers || first_answers_ == FirstAnswers::kReportedMissing)) return;
  std::vector<RobotId> robots;
  std::vector<std::string> hosts;
  for (const AgentId agent : barrier_.Missing()) {
    const Member& member = run_.members.member(agent);
    robots.insert(robots.end(), member.robots.begin(), member.robots.end());
    if (std::find(hosts.begin(), hosts.end(), member.host) == hosts.end()) hosts.push_back(member.host);
  }
  std::sort(robots.begin(), robots.end());
  std::string text = "no answer to the first frame from the agents of " + ListNames(run_.world(), robots) + " (on";
  for (const std::string& host : hosts) text += " " + host;
  text += ") within " + std::to_string(static_cast<int>(waited)) + " s";
  if (!run_.options.advice_on_silence.empty()) text += "; " + run_.options.advice_on_silence;
  if (is_over) return Fail(Failure(std::move(text)), now);
  first_answers_ = FirstAnswers::kReportedMissing;
  run_.notices.Add(std::move(text));
}

bool TickEngine::halted() const {
  if (run_.members.all_robots_present()) return false;
  const OnAgentLoss policy = run_.options.settings.on_agent_loss;
  return policy == OnAgentLoss::kPause || policy == OnAgentLoss::kRebuild || run_.members.present_members() == 0;
}

double TickEngine::NextDue() const {
  return pace_ == Pace::kAtOnce ? committed_at_ : pacer_.Due(run_.next_tick());
}

bool TickEngine::observers_ready() const {
  return std::all_of(run_.observers.begin(), run_.observers.end(),
                     [](RunObserver* observer) { return observer->IsReady(); });
}

bool TickEngine::observers_prepared() const {
  return std::all_of(run_.observers.begin(), run_.observers.end(),
                     [](RunObserver* observer) { return observer->IsPrepared(); });
}

bool TickEngine::ReadyToCommit(double now) {
  const bool due = run_.phase == RunPhase::kRunning && !run_.frame.paused && (run_.realtime() || barrier_.complete()) &&
                   now >= NextDue() && !halted();
  // Observers are asked last, and only for a tick that is due: the time they take to be ready is then time that ticks
  // have waited for them.
  if (!due || !observers_prepared()) return false;
  if (observers_ready()) return true;
  if (!observers_wait_since_) observers_wait_since_ = now;
  return false;
}

void TickEngine::Begin(double now) {
  run_.phase = RunPhase::kRunning;
  std::vector<AdmissionMessage> admissions;
  for (const AgentId agent : run_.members.PresentMembers()) {
    run_.members.Find(agent)->silent_since.reset();  // its silence counts from the first frame on, not from its join
    admissions.push_back(MakeAdmission(run_, agent, true));
  }
  run_.endpoint.SendAdmissions(admissions);
  run_.started_at = now;
  if (run_.continues()) return Continue(now);
  pacer_.Start(now);
  FrameMessage first = run_.frame;
  first.events = run_.events.CompleteFrame(0, {});
  first.paused = ticks_to_pause_ == 0U || ShowsTick(0);
  Publish(std::move(first), {}, now);
}

bool TickEngine::ShowsTick(Tick tick) const {
  return std::any_of(run_.observers.begin(), run_.observers.end(),
                     [tick](RunObserver* observer) { return observer->ShowsTick(tick); });
}

FrameStage TickEngine::StageOf(const FrameMessage& frame, bool shows) {
  if (!frame.paused) return FrameStage::kDeciding;
  return shows ? FrameStage::kPublishing : FrameStage::kPaused;
}

void TickEngine::AdvanceRelease(double now) {
  if (released() || !pause_answered() || halted()) return;
  Status outcome;
  if (std::exchange(stage_, FrameStage::kAwaitingRelease) == FrameStage::kPublishing) {
    // Once for each frame, also if several polls ask for its release.
    outcome = CallObservers(run_.observers, [&](RunObserver& observer) { return observer.OnShown(run_.frame); });
  }
  awaited_.clear();
  const Status asked = CallObservers(run_.observers, [&](RunObserver& observer) -> Status {
    Result<TickRelease> release = observer.Release();
    if (!release.ok()) return release.error();
    const TickRelease& of_observer = release.value();
    awaited_.insert(awaited_.end(), of_observer.awaited.begin(), of_observer.awaited.end());
    return {};
  });
  if (outcome.ok()) outcome = asked;
  if (!outcome.ok()) return Fail(outcome.error(), now);
  if (!awaited_.empty()) return;
  stage_ = FrameStage::kPaused;
  // A pause that a user wants remains, although nothing is awaited any more.
  if (ticks_to_pause_ != 0U) SendUnpaused(false, now);
}

void TickEngine::Continue(double now) {
  FrameMessage& frame = run_.frame;
  pacer_.Resume(frame.state.tick, now);
  // If an agent has decided on the frame already, the service before had released it.
  const bool shows = !run_.is_decided && ShowsTick(frame.state.tick);
  frame.last = IsLast(frame.state.tick);
  frame.paused = !frame.last && (ticks_to_pause_ == 0U || shows);
  stage_ = StageOf(frame, shows);
  frame.holds = frame.paused && ticks_to_pause_ != 0U;
  if (!frame.paused) frame.commands = commands_.Sent();  // as of the service before: an agent may have answered it
  if (run_.members.present_members() == 0) halted_since_ = now;
  run_.endpoint.SendFrame(frame);
  OpenBarrier(now);
  if (run_.is_branch()) ReportBranch(now);
  if (!frame.last) return;
  // The agents that were there may have left because they have seen the last frame: they are not lost.
  std::vector<RobotId> lost = run_.members.AbsentRobots();
  const std::vector<RobotId>& before = run_.options.resumed->progress.absent;
  std::erase_if(lost, [&](RobotId robot) { return std::find(before.begin(), before.end(), robot) == before.end(); });
  End(now, lost);
}

void TickEngine::ReportBranch(double now) {
  CommittedTick begin{.frame = run_.frame, .proposals = {}};
  begin.is_recorded = true;
  const RunProgress progress = Progress();
  const Status outcome = CallObservers(run_.observers, [&](RunObserver& observer) {
    Status committed = observer.OnCommit(begin, progress);
    return committed.ok() ? observer.OnTick(begin) : committed;
  });
  if (!outcome.ok()) Fail(outcome.error(), now);
}

bool TickEngine::IsLast(Tick tick) const {
  return run_.options.settings.ticks && tick >= *run_.options.settings.ticks;
}

RunProgress TickEngine::Progress() const {
  RunProgress progress;
  progress.incarnation = run_.options.incarnation;
  if (!play_after_edits_) progress.ticks_to_pause = ticks_to_pause_;
  if (!run_.members.all_robots_present()) {
    progress.absent = run_.members.AbsentRobots();
    // Robots of an edit that are still expected are not absent: the service that continues asks for their agents again.
    for (const RobotId robot : run_.newcomers) std::erase(progress.absent, robot);
  }
  progress.newcomers = run_.newcomers;
  progress.stalls = run_.events.stalls();
  progress.rejected = run_.events.rejected();
  progress.speed_is_set = speed_is_set_;
  if (speed_is_set_) progress.speed = speed();
  progress.commands = commands_.InForce();
  progress.inputs = inputs_;
  if (run_.continues()) progress.first_number = run_.options.resumed->progress.first_number;
  return progress;
}

// Of devices that an edit has removed.
void TickEngine::DropInvalidInputs() {
  std::erase_if(inputs_, [&](const Input& input) { return !CheckInput(*run_.scene, input).ok(); });
}

void TickEngine::ReportProgress(double now) {
  const RunProgress progress = Progress();
  const Status outcome =
      CallObservers(run_.observers, [&](RunObserver& observer) { return observer.OnProgress(progress); });
  if (!outcome.ok()) Fail(outcome.error(), now);
}

void TickEngine::OpenBarrier(double now) {
  committed_at_ = arrived_at_ = now;
  barrier_.Open(run_.next_tick());
  // In one process no message is lost, and a resend would only mean that a robot computes for long.
  if (run_.endpoint.may_lose_messages()) {
    resend_timer_.Start(now);
  } else {
    resend_timer_.Start(now, ResendTimer::kMaxWait);
  }
}

void TickEngine::Commit(double now) {
  if (run_.realtime()) {
    for (AgentId agent : barrier_.Missing()) {
      std::optional<double>& since = run_.members.Find(agent)->silent_since;
      if (!since) since = committed_at_;
    }
    if (const std::optional<int> late = pace_watch_.Committed(barrier_.members(), barrier_.missing(), now)) {
      run_.notices.Add(std::to_string(*late) + " percent of the proposals come too late for the pace of " +
                       SpeedText(*pacer_.speed()) +
                       " x real time: those robots keep their last command for a tick, then stop; a lower --speed, or "
                       "`troupe ctl speed`, helps");
    }
  }
  if (observers_wait_since_) observers_waited_ += now - *std::exchange(observers_wait_since_, std::nullopt);
  first_answers_ = FirstAnswers::kComplete;  // of agents that are not lost
  EnterPhase(TickPhase::kStep, run_.next_tick());
  // Before the step: the commands that the agents had for this tick have been in force for it.
  commands_.Elapse();
  ++steps_;
  const std::span<const Proposal> proposals = proposals_.ForStep(run_.frame.state);
  // In the order in which a recording keeps them, so that a replay applies them in the same one.
  const std::vector<Input> inputs = ByKind(std::exchange(inputs_, {}));
  StepResult result = stepper_->Step(run_.frame.state, proposals, inputs);
  FrameMessage next = SuccessorOf(run_.frame);
  next.state = std::move(result.state);
  next.state_hash = StateHash(next.state);
  run_.memories.OnStep(next);
  run_.restoring = next.remembered = false;
  next.events = run_.events.CompleteFrame(next.state.tick, std::move(result.events));
  if (ticks_to_pause_) --*ticks_to_pause_;
  next.paused = ticks_to_pause_ == 0U || ShowsTick(next.state.tick);
  // A paused frame is not decided on: its commands are sent, and begin to elapse, with the frame that resumes.
  if (!next.paused) next.commands = commands_.ForNextTick(run_.world());
  pacer_.Committed(next.state.tick, now);
  Publish(std::move(next), {.proposals = proposals, .inputs = inputs}, now);
}

// The phases of the trace, and their means.
void TickEngine::EnterPhase(TickPhase phase, Tick tick) {
  Enter(run_.options.trace, run_.options.phase_times, phase, tick);
}

void TickEngine::Resume(double now) {
  if (run_.options.phase_times != nullptr) run_.options.phase_times->Restart();  // a pause is no wait
  pacer_.Resume(run_.frame.state.tick, now);
  if (released()) return SendUnpaused(true, now);
  ResendHold();
  ReportProgress(now);
  AdvanceRelease(now);
}

void TickEngine::ResendHold() {
  if (std::exchange(run_.frame.holds, holding()) != holding()) run_.endpoint.SendFrame(run_.frame);
}

// The progress has the commands that agents know, and the end of a pause.
void TickEngine::SendUnpaused(bool ends_pause, double now) {
  stage_ = FrameStage::kDeciding;
  run_.frame.paused = run_.frame.holds = false;
  run_.frame.commands = commands_.ForNextTick(run_.world());
  if (ends_pause || !run_.frame.commands.empty()) ReportProgress(now);
  if (run_.phase != RunPhase::kRunning) return;
  run_.endpoint.SendFrame(run_.frame);
  OpenBarrier(now);
}

void TickEngine::SetSpeed(std::optional<double> speed, double now) {
  pacer_.SetSpeed(speed, run_.world().interval_seconds(), run_.frame.state.tick, now);
  speed_is_set_ = true;
}

void TickEngine::ChangeWorld(std::span<const AgentId> removed) {
  stepper_ = std::make_unique<Stepper>(*run_.scene, run_.options.pool);
  for (const AgentId agent : removed) barrier_.RemoveMember(agent);
  pacer_.SetInterval(run_.world().interval_seconds());
}

void TickEngine::PublishEdit(FrameMessage next, const AppliedEdit& edit, double now, bool is_recorded) {
  // Proposals for the state before the edit may have been collected; none may enter a step from the new one.
  proposals_.ChangeWorld(*run_.scene);
  if (run_.members.present_members() == 0) halted_since_ = now;
  next.state_hash = StateHash(next.state);
  next.events = run_.events.CompleteFrame(next.state.tick, std::move(next.events));
  next.paused = true;
  // Commands name robots by id, and goals refer to the world as it was: both end with it.
  if (is_recorded || next.fresh_edition == next.edition) {
    commands_.Clear();
    inputs_.clear();
  }
  DropInvalidInputs();
  ticks_to_pause_ = 0;
  Publish(std::move(next), {.edit = &edit, .is_recorded = is_recorded}, now);
}

void TickEngine::Publish(FrameMessage next, const Origin& origin, double now) {
  const Tick tick = next.state.tick;
  next.last = IsLast(tick);
  // Agents leave at the last frame, so no pause could end.
  if (next.last) next.paused = false;
  const FrameStage stage = StageOf(next, next.paused && ShowsTick(tick));
  next.holds = next.paused && ticks_to_pause_ != 0U;
  const auto committed = [&](const FrameMessage& frame, const FrameMessage& before) -> CommittedTick {
    if (origin.edit != nullptr) {
      return {.frame = frame,
              .proposals = {},
              .edit = origin.edit,
              .before = &before.state,
              .is_recorded = origin.is_recorded};
    }
    return {.frame = frame, .proposals = origin.proposals, .commands = before.commands, .inputs = origin.inputs};
  };
  EnterPhase(TickPhase::kRecord, tick);
  const RunProgress progress = Progress();
  Status outcome = CallObservers(
      run_.observers, [&](RunObserver& observer) { return observer.OnCommit(committed(next, run_.frame), progress); });
  if (!outcome.ok()) return Fail(outcome.error(), now);
  EnterPhase(TickPhase::kPublish, tick);
  const bool changes_world = next.world_edition != run_.frame.world_edition;
  const FrameMessage before = std::exchange(run_.frame, std::move(next));
  stage_ = stage;
  // Before the frame, which refers to the new world by its edition.
  if (changes_world) AnnounceSession(run_);
  run_.endpoint.SendFrame(run_.frame);  // before the observers' other work, so that the agents work meanwhile
  EnterPhase(TickPhase::kRecord, tick);
  OpenBarrier(now);
  outcome = CallObservers(run_.observers,
                          [&](RunObserver& observer) { return observer.OnTick(committed(run_.frame, before)); });
  if (!outcome.ok()) return Fail(outcome.error(), now);
  if (run_.frame.last) return End(now, run_.members.AbsentRobots());
  EnterPhase(TickPhase::kWait, run_.next_tick());
}

void TickEngine::Stop(double now) {
  if (run_.phase == RunPhase::kEnding || run_.phase == RunPhase::kOver) return;
  run_.interrupted = true;
  End(now, run_.members.AbsentRobots());
}

void TickEngine::Fail(Error error, double now) {
  if (run_.phase == RunPhase::kEnding || run_.phase == RunPhase::kOver) return;
  run_.error = std::move(error);
  End(now, run_.members.AbsentRobots());
}

void TickEngine::End(double now, const std::vector<RobotId>& lost) {
  // First, so that the run ends also if the rest throws.
  run_.phase = run_.members.present_members() == 0 ? RunPhase::kOver : RunPhase::kEnding;
  end_at_ = now + kMaxEnd;
  resend_timer_.Start(now, kFirstResendOfLast);
  if (!std::exchange(run_.frame.last, true)) run_.endpoint.SendFrame(run_.frame);
  for (RobotId robot : lost) run_.lost_robots.push_back(run_.world().robot(robot).name);
}

void TickEngine::Poll(double now) {
  AdvanceRelease(now);
  if (ReadyToCommit(now)) return Commit(now);
  if (run_.phase == RunPhase::kEnding && now >= end_at_) run_.phase = RunPhase::kOver;
  if (run_.phase == RunPhase::kOver) return;
  const double timeout = run_.options.start_timeout_seconds;
  if (run_.phase == RunPhase::kRunning && run_.members.present_members() == 0 && halted() && timeout > 0.0 &&
      now - halted_since_ >= timeout) {
    return Fail(Failure("every agent is lost, and none has rejoined"), now);
  }
  if (now < ResendDue()) return;
  ResendFrame();
  ++frames_resent_;
  resent_at_ = now;
  resend_timer_.Resent(now);
}

double TickEngine::ResendDue() const {
  if (run_.phase == RunPhase::kEnding || !barrier_.complete()) return resend_timer_.due();
  // A lost agent that lives may have answered everything that it received, in a pause, too. It rejoins with another
  // answer.
  if (halted()) return std::max(committed_at_, resent_at_) + kHaltedResend;
  return kNever;
}

void TickEngine::ResendFrame() {
  std::vector<AgentId>& awaited = run_.frame.awaited;
  awaited.clear();
  // The last frame is for all: an agent that leaves does not answer.
  if (run_.phase == RunPhase::kRunning && 2 * barrier_.missing() <= barrier_.members()) {
    awaited = barrier_.complete() ? run_.members.LostMembers() : barrier_.Missing();
  }
  run_.endpoint.SendFrame(run_.frame);
  awaited.clear();
}

double TickEngine::NextPoll() const {
  if (run_.phase == RunPhase::kEnding) return std::min(end_at_, ResendDue());
  if (run_.phase != RunPhase::kRunning) return run_.created_at;
  const bool can_step = (run_.realtime() || barrier_.complete()) && !halted() && !run_.frame.paused;
  // Observers are asked again at any poll.
  const double step = can_step && observers_ready() && observers_prepared() ? NextDue() : kNever;
  return std::min(step, ResendDue());
}

}  // namespace troupe
