// TickEngine and the members of the run: their proposals and reports, and their loss.

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "world-service/service/tick_engine.h"

namespace troupe {
namespace {

// Wall times, s.
constexpr double kAskPeriod = 0.1;         // from one request to an agent to join again to the next
constexpr double kLongWait = 5.0;          // of silence, until a notice
constexpr double kNotePeriod = 30.0;       // from a notice of a long wait to the next one
constexpr double kLatencySmoothing = 0.1;  // its share in the smoothed time of an agent's answers

constexpr std::size_t kProcessesNamed = 3;  // in a notice

// The state that a proposal is for.
StatePlace PlaceOf(const ProposalMessage& proposal) {
  return {proposal.edition, proposal.tick};
}

}  // namespace

void TickEngine::AddMember(Member& member, double now) {
  member.silent_since = now;
  barrier_.AddMember(member.id);
  has_changed_members_ = true;
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

void TickEngine::OnAgentGone(AgentId agent, const std::string& reason, double now) {
  supervised_.erase(agent);
  Member* const member = run_.members.Find(agent);
  if (member == nullptr) return;
  member->gone = true;
  if (member->present) Lose(*member, reason, now);
}

void TickEngine::OnAgentSilent(AgentId agent, double now) {
  // Its process lives, and answers when it runs again: a machine with too much work loses no robot by that.
  if (supervised_.contains(agent) && !run_.options.lease_is_limit) return;
  OnAgentGone(agent, "it gave no sign of life for its lease", now);
}

void TickEngine::Lose(Member& member, const std::string& reason, double now) {
  run_.members.Lose(member);
  barrier_.RemoveMember(member.id);
  has_new_losses_ = has_changed_members_ = true;
  end_at_ = EndWithout(now);
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

void TickEngine::WatchSilentMembers(double now) {
  // In one process no message is lost: whoever has not answered still computes, or the whole program was stopped.
  if (run_.phase != RunPhase::kRunning || barrier_.complete() || !run_.endpoint.may_lose_messages()) return;
  // Before the first answers a silent agent says nothing about itself: the network may drop the frames to its host.
  if (first_answers_ != FirstAnswers::kComplete && !run_.realtime() && !run_.takes_over())
    return AwaitFirstAnswers(now);
  const double deadline = run_.options.settings.agent_deadline_seconds;
  if (deadline <= 0.0) return NoteLongWait(now);
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

std::string TickEngine::MissingText() const {
  std::vector<RobotId> robots;
  std::string processes;
  std::size_t count = 0;
  for (const AgentId agent : barrier_.Missing()) {
    const Member& member = run_.members.member(agent);
    robots.insert(robots.end(), member.robots.begin(), member.robots.end());
    if (++count <= kProcessesNamed) processes += (count == 1 ? "" : "; ") + Describe(member);
  }
  std::sort(robots.begin(), robots.end());
  if (count > kProcessesNamed) processes += "; and " + std::to_string(count - kProcessesNamed) + " more";
  return ListNames(run_.world(), robots) + " (" + processes + ")";
}

// A network that does not pass the frames on to all hosts loses no agent: the run has not begun for those.
void TickEngine::AwaitFirstAnswers(double now) {
  const double waited = now - arrived_at_;
  const double timeout = run_.options.start_timeout_seconds;
  const bool is_over = timeout > 0.0 && waited >= timeout;
  if (!is_over && (waited < kLongWait || first_answers_ == FirstAnswers::kReportedMissing)) return;
  std::string text = "no answer to the first frame from the agents of " + MissingText() + " within " +
                     std::to_string(static_cast<int>(waited)) + " s";
  if (!run_.options.advice_on_silence.empty()) text += "; " + run_.options.advice_on_silence;
  if (is_over) return Fail(Failure(std::move(text)), now);
  first_answers_ = FirstAnswers::kReportedMissing;
  run_.notices.Add(std::move(text));
}

void TickEngine::NoteLongWait(double now) {
  const double waited = now - arrived_at_;
  if (run_.realtime() || waited < kLongWait || (noted_at_ && now < *noted_at_ + kNotePeriod)) return;
  noted_at_ = now;
  run_.notices.Add("tick " + std::to_string(run_.next_tick()) + " waits for the agents of " + MissingText() +
                   ": no answer for " + std::to_string(static_cast<int>(waited)) +
                   " s, but nothing shows that they have ended");
}

void TickEngine::NoteFrozenRobots() {
  if (!std::exchange(has_new_losses_, false) || run_.members.all_robots_present()) return;
  for (const RobotId robot : run_.members.AbsentRobots()) frozen_.insert(run_.world().robot(robot).name);
}

}  // namespace troupe
