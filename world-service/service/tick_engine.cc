#include "world-service/service/tick_engine.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/or_failure.h"
#include "common/model/lane_trips.h"
#include "common/model/states.h"
#include "common/spatial/check_order.h"

namespace troupe {
namespace {

// Wall times, s.
constexpr double kFirstResendOfLast = 0.02;  // of the last frame: agents that missed it delay the end
// For agents to leave, since the newest one has left: messages may be under way over a slow network.
constexpr double kMaxEnd = 5.0;
constexpr double kMaxEndInProcess = 1.0;
constexpr double kHaltedResend = 0.5;  // of the frame, while the run waits for lost agents
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
      resend_timer_(run.options.settings.agent_deadline_seconds),
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
    frozen_ = resumed.progress.frozen;
  } else {
    run_.frame.state = InitialState(*run_.scene);
    run_.frame.state_hash = StateHash(run_.frame.state);
  }
  run_.frame.run = run_.options.run;
  run_.frame.incarnation = run_.options.incarnation;
}

void TickEngine::Wake(double now) {
  if (run_.phase != RunPhase::kRunning) return;
  const Status outcome = CallObservers(run_.observers, [](RunObserver& observer) { return observer.OnWake(); });
  if (!outcome.ok()) Fail(outcome.error(), now);
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
  frame.last = IsLast(frame.state);
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

bool TickEngine::IsLast(const WorldState& state) const {
  if (run_.options.settings.ticks && state.tick >= *run_.options.settings.ticks) return true;
  return AreTripsDone(run_.world(), state);
}

RunProgress TickEngine::Progress() const {
  RunProgress progress;
  // A service that continues a run and has not all of its agents yet does not know which of them are absent: all that
  // tools cannot change meanwhile is as the service before left it.
  const bool gathers = run_.phase == RunPhase::kGathering && run_.continues();
  if (gathers) progress = run_.options.resumed->progress;
  progress.incarnation = run_.options.incarnation;
  progress.ticks_to_pause = play_after_edits_ ? std::nullopt : ticks_to_pause_;
  progress.speed_is_set = speed_is_set_;
  if (speed_is_set_) progress.speed = speed();
  if (gathers) return progress;
  if (!run_.members.all_robots_present()) {
    progress.absent = run_.members.AbsentRobots();
    // Robots of an edit that are still expected are not absent: the service that continues asks for their agents again.
    for (const RobotId robot : run_.newcomers) std::erase(progress.absent, robot);
  }
  progress.newcomers = run_.newcomers;
  progress.stalls = run_.events.stalls();
  progress.rejected = run_.events.rejected();
  progress.frozen = frozen_;
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
  NoteFrozenRobots();
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
  run_.vehicle_states.Add(run_.world(), proposals);
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
  has_new_losses_ = true;
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
  next.last = IsLast(next.state);
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

double TickEngine::EndWithout(double now) const {
  return now + (run_.endpoint.may_lose_messages() ? kMaxEnd : kMaxEndInProcess);
}

void TickEngine::End(double now, const std::vector<RobotId>& lost) {
  // First, so that the run ends also if the rest throws.
  run_.phase = run_.members.present_members() == 0 ? RunPhase::kOver : RunPhase::kEnding;
  end_at_ = EndWithout(now);
  resend_timer_.Start(now, kFirstResendOfLast);
  if (!std::exchange(run_.frame.last, true)) run_.endpoint.SendFrame(run_.frame);
  for (RobotId robot : lost) run_.lost_robots.push_back(run_.world().robot(robot).name);
}

void TickEngine::Poll(double now) {
  // So that a service that continues the run waits for the agents that there are. Once for many changes; each tick has
  // them, too.
  if (std::exchange(has_changed_members_, false) && run_.frame.paused && run_.phase == RunPhase::kRunning) {
    ReportProgress(now);
  }
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
