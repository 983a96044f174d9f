#include "world-service/service/tick_coordinator.h"

#include <limits>
#include <utility>

namespace troupe {

TickCoordinator::TickCoordinator(const std::shared_ptr<const Scene>& scene, const CoordinatorOptions& options,
                                 ServiceEndpoint& endpoint, RunObservers observers, double now)
    : run_{.options = options,
           .endpoint = endpoint,
           .observers = std::move(observers),
           .created_at = now,
           .scene = scene,
           .members = Membership(scene->world(), options.lease_seconds)},
      engine_(run_, now),
      editor_(run_, engine_),
      control_(run_, engine_, editor_),
      statistics_(run_, engine_, editor_, now) {
  if (run_.realtime()) {
    run_.notices.Add("mode realtime does not wait for late robots: two runs of it are not the same");
  }
}

std::optional<double> TickCoordinator::startup_seconds() const {
  if (!run_.started_at) return std::nullopt;
  return *run_.started_at - run_.created_at;
}

void TickCoordinator::OnJoin(const JoinMessage& join, double now) {
  if (join.run != run_.options.run || run_.phase == Phase::kOver) return;
  if (run_.phase == Phase::kEnding) return AnswerJoin(join, false, "the run is over");
  const JoinDecision decision = run_.members.Join(join, run_.next_tick(), now);
  switch (decision.outcome) {
    case JoinDecision::Outcome::kUndecided:
      return;
    case JoinDecision::Outcome::kRefused:
      return AnswerJoin(join, false, decision.reason);
    case JoinDecision::Outcome::kRepeated:
      return AnswerJoin(join, true, {});
    case JoinDecision::Outcome::kAdmitted:
      AnswerJoin(join, true, {});
      engine_.AddMember(*decision.member, now);
      editor_.OnJoined(decision.member->robots);
      if (run_.phase == Phase::kGathering && run_.members.all_robots_present()) return Begin(now);
      if (run_.phase == Phase::kRunning) run_.endpoint.SendFrame(run_.frame);  // sent before this agent was there
      return;
  }
}

// Agents that join before the run begins are admitted together when it does.
void TickCoordinator::AnswerJoin(const JoinMessage& join, bool admitted, const std::string& reason) {
  if (admitted && run_.phase == Phase::kGathering) return;
  run_.endpoint.SendAdmissions({{run_.options.run, join.agent, admitted, reason}});
}

void TickCoordinator::Begin(double now) {
  statistics_.OnBegin(now);
  engine_.Begin(now);
  control_.Advance(now);
}

void TickCoordinator::OnProposal(const ProposalMessage& proposal, double now) {
  engine_.OnProposal(proposal, now);
  control_.Advance(now);
}

void TickCoordinator::OnAgentGone(AgentId agent, double now) {
  engine_.OnAgentGone(agent, now);
  control_.Advance(now);
}

void TickCoordinator::OnRivalService(const SessionMessage& rival, double now) {
  if (rival.run == run_.options.run) return;
  if (run_.started_at && !rival.begun) Announce();  // for the rival, which cannot know that this run has begun
  const std::string process = rival.host + ", pid " + std::to_string(rival.pid);
  if (run_.phase == Phase::kGathering && (rival.begun || rival.run < run_.options.run)) {
    return Fail(Failure("another world service runs in this session (" + process + "); use another session name"), now);
  }
  if (rival.run == known_rival_) return;
  known_rival_ = rival.run;
  run_.notices.Add("another world service has entered this session (" + process + "); this one continues");
}

void TickCoordinator::Poll(double now) {
  if (run_.phase == Phase::kGathering) return PollGathering(now);
  engine_.LoseSilentMembers(now);
  control_.Advance(now);
  if (run_.phase == Phase::kRunning) GiveUpNewRobots(now);
  engine_.Poll(now);
  control_.Advance(now);
}

void TickCoordinator::PollGathering(double now) {
  if (run_.members.all_robots_present()) return Begin(now);
  const double timeout = run_.options.start_timeout_seconds;
  if (timeout <= 0.0 || now - run_.created_at < timeout) return;
  Fail(Failure("no agent joined for " + ListNames(run_.world(), run_.members.AbsentRobots()) + " within " +
               std::to_string(static_cast<int>(timeout)) + " s"),
       now);
}

void TickCoordinator::GiveUpNewRobots(double now) {
  const Status in_time = editor_.CheckTimeout(now);
  if (in_time.ok()) return;
  control_.GiveUpNewRobots(in_time.error(), now);
  control_.Advance(now);
}

double TickCoordinator::NextPoll() const {
  if (run_.phase != Phase::kGathering) return engine_.NextPoll();
  return run_.members.all_robots_present() ? run_.created_at : std::numeric_limits<double>::infinity();
}

void TickCoordinator::Control(const ControlRequest& request, ControlReplyTo reply, double now, RequestedWorld world) {
  control_.Execute(request, std::move(reply), std::move(world), now);
  control_.Advance(now);
}

void TickCoordinator::Stop(double now) {
  engine_.Stop(now);
  control_.Advance(now);
}

void TickCoordinator::Fail(Error error, double now) {
  engine_.Fail(std::move(error), now);
  control_.Advance(now);
}

}  // namespace troupe
