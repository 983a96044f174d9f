#include "world-service/service/tick_coordinator.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/version.h"
#include "common/model/state_hash.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

// Wall times, s.
constexpr double kFirstRepeatOfLast = 0.02;  // of the last frame: agents that missed it hold up the end
constexpr double kLongestEnd = 1.0;          // that agents get to leave
constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr std::size_t kNamesListed = 10;

std::optional<double> SpeedOf(const RunSettings& settings) {
  if (settings.mode == Mode::kRealtime) return settings.speed.value_or(1.0);
  return settings.speed;
}

}  // namespace

TickCoordinator::TickCoordinator(const Scene& scene, const CoordinatorOptions& options, ServiceEndpoint& endpoint,
                                 Recorder& recorder, double now, WorldGateway* gateway)
    : scene_(std::shared_ptr<void>(), &scene),  // the caller's
      original_(scene_),
      bodies_(scene),
      options_(options),
      endpoint_(endpoint),
      recorder_(recorder),
      gateway_(gateway),
      members_(scene.world(), options.lease_seconds),
      proposals_(scene.world(), options.settings.mode),
      pacer_(SpeedOf(options.settings), scene.world().interval_seconds()),
      created_at_(now),
      status_at_(now) {
  if (options.start_paused) ticks_to_pause_ = 0;
  frame_.run = options_.run;
  frame_.state = InitialState(scene_->world());
  frame_.state_hash = StateHash(frame_.state);
  if (realtime()) {
    notices_.push_back("mode realtime does not wait for late robots: two runs of it are not the same");
  }
}

void TickCoordinator::Announce() {
  SessionMessage session;
  session.run = options_.run;
  session.protocol_version = kProtocolVersion;
  session.host = options_.host;
  session.pid = options_.pid;
  session.lease_seconds = options_.lease_seconds;
  session.begun = started_at_.has_value();
  session.world = scene_->world();
  session.world_edition = frame_.world_edition;
  endpoint_.SendSession(session);
}

void TickCoordinator::OnJoin(const JoinMessage& join, double now) {
  if (join.run != options_.run || phase_ == Phase::kOver) return;
  if (phase_ == Phase::kEnding) return Answer(join, false, "the run is over");
  const JoinDecision decision = members_.Join(join, next_tick(), now);
  switch (decision.outcome) {
    case JoinDecision::Outcome::kUndecided:
      return;
    case JoinDecision::Outcome::kRefused:
      return Answer(join, false, decision.reason);
    case JoinDecision::Outcome::kRepeated:
      return Answer(join, true, {});
    case JoinDecision::Outcome::kAdmitted:
      Answer(join, true, {});
      TakeUp(*decision.member, now);
      if (phase_ == Phase::kGathering && members_.all_robots_present()) return Begin(now);
      if (phase_ == Phase::kRunning) endpoint_.SendFrame(frame_);  // it may have come too late for this one
      return;
  }
}

void TickCoordinator::Answer(const JoinMessage& join, bool admitted, const std::string& reason) {
  // Who comes before the run begins is told when it does.
  if (admitted && phase_ == Phase::kGathering) return;
  endpoint_.SendAdmissions({{options_.run, join.agent, admitted, reason}});
}

// From now on the barrier waits for the member.
void TickCoordinator::TakeUp(Member& member, double now) {
  member.silent_since = now;
  barrier_.AddMember(member.id);
  for (RobotId robot : member.robots) {
    events_.Add(EventType::kJoined, frame_.state.tick, robot, Describe(member));
    std::erase(newcomers_, robot);
  }
}

void TickCoordinator::OnProposal(const ProposalMessage& proposal, double now) {
  if (phase_ != Phase::kRunning) return;
  if (proposal.run != options_.run) return Reject("a proposal for another run", now);
  Member* const member = members_.Find(proposal.agent);
  if (member == nullptr) return Reject("a proposal of an agent that has not joined", now);
  if (proposal.edition < frame_.edition) return;  // of the world before an edit
  if (proposal.edition > frame_.edition) {
    return Reject("a proposal of " + Describe(*member) + " for edition " + std::to_string(proposal.edition) +
                      ", expected " + std::to_string(frame_.edition),
                  now);
  }
  if (proposal.tick > next_tick()) {
    return Reject("a proposal of " + Describe(*member) + " for tick " + std::to_string(proposal.tick) + ", expected " +
                      std::to_string(next_tick()),
                  now);
  }
  if (proposal.tick < next_tick()) {
    // Usually the answer to a repeated frame. In realtime mode it may be news, and is the robot's last command.
    const bool late = realtime() && proposal.tick == frame_.state.tick && proposal.tick > member->last_answered;
    if (!late || !member->present) return;
    TakeProposals(*member, proposal, now);
    return;
  }
  if (proposal.held != frame_.paused) return;  // answers the frame as it was before
  if (!member->present) {
    members_.Restore(*member);
    TakeUp(*member, now);
  }
  if (!barrier_.Arrive(proposal.agent)) return repeat_timer_.Needless();
  if (proposal.held) {
    member->silent_since.reset();
    repeat_timer_.Answered(now);
    if (settled()) Settle(now);
    return;
  }
  TakeProposals(*member, proposal, now);
  if (barrier_.complete()) {
    ++member->times_last;
    member->waited_seconds += now - arrived_at_;
  }
  arrived_at_ = now;
  repeat_timer_.Answered(now);
  if (ReadyToCommit(now)) Commit(now);
}

void TickCoordinator::TakeProposals(Member& member, const ProposalMessage& message, double now) {
  member.last_answered = message.tick;
  member.silent_since.reset();
  for (const Rejection& rejection : proposals_.Take(member, message, frame_.state)) {
    events_.Reject(frame_.state.tick, rejection.robot, rejection.reason, now);
  }
  for (const std::string& report : message.reports) {
    if (notices_.size() < kNoticesKept) notices_.push_back(Describe(member) + ": " + report);
  }
}

void TickCoordinator::Reject(std::string reason, double now) {
  events_.Reject(frame_.state.tick, std::nullopt, std::move(reason), now);
}

void TickCoordinator::OnAgentGone(AgentId agent, double now) {
  Member* const member = members_.Find(agent);
  if (member == nullptr || !member->present) return;
  Lose(*member, "it ended, or its lease ran out", now);
}

void TickCoordinator::Lose(Member& member, const std::string& why, double now) {
  members_.Lose(member);
  barrier_.RemoveMember(member.id);
  if (members_.present_members() == 0) halted_since_ = now;
  if (phase_ == Phase::kEnding) {
    if (members_.present_members() == 0) phase_ = Phase::kOver;
    return;
  }
  for (RobotId robot : member.robots) {
    events_.Add(EventType::kLeft, frame_.state.tick, robot, Describe(member) + ": " + why);
  }
  if (phase_ != Phase::kRunning) return;
  if (options_.settings.on_agent_loss == OnAgentLoss::kAbort) {
    return Fail({{}, "the agent of " + ListNames(member.robots) + " (" + Describe(member) + ") is lost: " + why}, now);
  }
  if (settled()) return Settle(now);
  if (ReadyToCommit(now)) Commit(now);
}

void TickCoordinator::LoseSilentMembers(double now) {
  const double deadline = options_.settings.agent_deadline_seconds;
  if (deadline <= 0.0 || barrier_.complete()) return;
  for (AgentId agent : barrier_.Missing()) {
    Member* const member = members_.Find(agent);
    const double silent = now - member->silent_since.value_or(committed_at_);
    if (silent < deadline) continue;
    Lose(*member, "it was silent for " + std::to_string(static_cast<int>(silent)) + " s", now);
    if (phase_ != Phase::kRunning) return;
  }
}

void TickCoordinator::OnRivalService(const SessionMessage& rival, double now) {
  if (rival.run == options_.run) return;
  if (started_at_ && !rival.begun) Announce();  // for the rival, which cannot know that this run has begun
  const std::string who = rival.host + ", pid " + std::to_string(rival.pid);
  if (phase_ == Phase::kGathering && (rival.begun || rival.run < options_.run)) {
    return Fail({{}, "another world service runs in this session (" + who + "); use another session name"}, now);
  }
  if (rival.run == known_rival_) return;
  known_rival_ = rival.run;
  notices_.push_back("another world service came into this session (" + who + "); this one goes on");
}

bool TickCoordinator::halted() const {
  if (members_.all_robots_present()) return false;
  return options_.settings.on_agent_loss == OnAgentLoss::kPause || members_.present_members() == 0;
}

bool TickCoordinator::ReadyToCommit(double now) const {
  const bool due = ticks_to_pause_.has_value() || now >= pacer_.Due(next_tick());  // who steps sets the pace
  return phase_ == Phase::kRunning && !frame_.paused && (realtime() || barrier_.complete()) && due && !halted();
}

void TickCoordinator::Begin(double now) {
  phase_ = Phase::kRunning;
  std::vector<AdmissionMessage> admissions;
  for (const AgentId agent : members_.PresentMembers()) admissions.push_back({options_.run, agent, true, {}});
  endpoint_.SendAdmissions(admissions);
  started_at_ = now;
  status_at_ = now;
  pacer_.Start(now);
  frame_.events = events_.TakeForFrame(0, {});
  frame_.paused = ticks_to_pause_ == 0U;
  Publish(now);
}

void TickCoordinator::Commit(double now) {
  if (realtime()) {
    for (AgentId agent : barrier_.Missing()) {
      std::optional<double>& since = members_.Find(agent)->silent_since;
      if (!since) since = committed_at_;
    }
  }
  Enter(options_.trace, TickPhase::kStep, next_tick());
  ++steps_made_;
  StepResult next = Step(*scene_, frame_.state, proposals_.ForStep(frame_.state), bodies_);
  frame_.state = std::move(next.state);
  frame_.state_hash = StateHash(frame_.state);
  frame_.events = events_.TakeForFrame(frame_.state.tick, std::move(next.events));
  if (ticks_to_pause_) --*ticks_to_pause_;
  frame_.paused = ticks_to_pause_ == 0U;
  pacer_.Committed(frame_.state.tick, now);
  Publish(now);
}

// The run goes on from a pause: the agents get the same frame again, to be answered.
void TickCoordinator::Resume(double now) {
  frame_.paused = false;
  endpoint_.SendFrame(frame_);
  committed_at_ = arrived_at_ = now;
  pacer_.Resume(frame_.state.tick, now);
  barrier_.Open(next_tick());
  repeat_timer_.Start(now);
}

void TickCoordinator::Publish(double now) {
  frame_.awaited.clear();
  frame_.last = options_.settings.ticks && frame_.state.tick >= *options_.settings.ticks;
  if (frame_.last) frame_.paused = false;
  Enter(options_.trace, TickPhase::kPublish, frame_.state.tick);
  endpoint_.SendFrame(frame_);  // first, so that the agents work while this goes on
  Enter(options_.trace, TickPhase::kRecord, frame_.state.tick);
  committed_at_ = arrived_at_ = now;
  barrier_.Open(next_tick());
  repeat_timer_.Start(now);
  if (gateway_ != nullptr) gateway_->Publish(frame_);
  if (Status error = recorder_.Write(frame_)) return Fail(*error, now);
  if (frame_.last) return End(now);
  Enter(options_.trace, TickPhase::kWait, next_tick());
}

void TickCoordinator::Stop(double now) {
  if (phase_ == Phase::kEnding || phase_ == Phase::kOver) return;
  interrupted_ = true;
  frame_.last = true;
  endpoint_.SendFrame(frame_);
  End(now);
}

void TickCoordinator::Fail(Error error, double now) {
  if (phase_ == Phase::kEnding || phase_ == Phase::kOver) return;
  error_ = std::move(error);
  frame_.last = true;
  endpoint_.SendFrame(frame_);
  End(now);
}

void TickCoordinator::End(double now) {
  for (RobotId robot : members_.AbsentRobots()) lost_at_end_.push_back(scene_->world().robot(robot).name);
  phase_ = members_.present_members() == 0 ? Phase::kOver : Phase::kEnding;
  AnswerAll("the run is over");
  end_at_ = now + kLongestEnd;
  repeat_timer_.Start(now, kFirstRepeatOfLast);
}

void TickCoordinator::Poll(double now) {
  if (phase_ == Phase::kGathering) {
    const double timeout = options_.start_timeout_seconds;
    if (members_.all_robots_present()) {
      Begin(now);
    } else if (timeout > 0.0 && now - created_at_ >= timeout) {
      Fail({{},
            "no agent came for " + ListNames(members_.AbsentRobots()) + " within " +
                std::to_string(static_cast<int>(timeout)) + " s"},
           now);
    }
    return;
  }
  if (phase_ == Phase::kRunning) LoseSilentMembers(now);
  if (phase_ == Phase::kRunning) GiveUpNewcomers(now);
  if (ReadyToCommit(now)) return Commit(now);
  if (phase_ == Phase::kEnding && now >= end_at_) phase_ = Phase::kOver;
  if (phase_ == Phase::kOver) return;
  if (phase_ == Phase::kRunning && halted() && members_.present_members() == 0 &&
      options_.start_timeout_seconds > 0.0 && now - halted_since_ >= options_.start_timeout_seconds) {
    return Fail({{}, "every agent is lost, and none came back"}, now);
  }
  const bool somebody_waits = phase_ == Phase::kEnding || !barrier_.complete();
  if (somebody_waits && now >= repeat_timer_.due()) {
    RepeatFrame();
    ++frames_repeated_;
    repeat_timer_.Repeated(now);
  }
}

void TickCoordinator::RepeatFrame() {
  frame_.awaited.clear();
  // The last frame is for everybody: who leaves does not answer.
  if (phase_ == Phase::kRunning && 2 * barrier_.missing() <= barrier_.members()) frame_.awaited = barrier_.Missing();
  endpoint_.SendFrame(frame_);
  frame_.awaited.clear();
}

double TickCoordinator::NextPoll() const {
  switch (phase_) {
    case Phase::kGathering:
      return members_.all_robots_present() ? created_at_ : kNever;
    case Phase::kRunning: {
      const bool can_step = (realtime() || barrier_.complete()) && !halted() && !frame_.paused;
      const double due = ticks_to_pause_ ? committed_at_ : pacer_.Due(next_tick());
      const double step = can_step ? due : kNever;
      return barrier_.complete() ? step : std::min(step, repeat_timer_.due());
    }
    case Phase::kEnding:
      return std::min(end_at_, repeat_timer_.due());
    case Phase::kOver:
      return created_at_;
  }
  return kNever;
}

std::vector<std::string> TickCoordinator::TakeNotices() {
  return std::exchange(notices_, {});
}

std::vector<std::string> TickCoordinator::TakeNewRobots() {
  return std::exchange(new_robots_, {});
}

std::string TickCoordinator::ListNames(const std::vector<RobotId>& robots) const {
  std::string list;
  for (std::size_t i = 0; i < robots.size() && i < kNamesListed; ++i) {
    list += (i == 0 ? "" : ", ") + scene_->world().robot(robots[i]).name;
  }
  if (robots.size() > kNamesListed) list += " and " + std::to_string(robots.size() - kNamesListed) + " more";
  return list;
}

}  // namespace troupe
