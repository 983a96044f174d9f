#include "world-service/service/tick_coordinator.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include "common/base/text.h"
#include "common/model/find_robots.h"

namespace troupe {
namespace {

// s, from a demand for history to its answer: agents that ask for the same states at about the same time get one
// answer.
constexpr double kHistoryDelay = 0.005;

Edition WorldEditionOf(const CoordinatorOptions& options) {
  return options.resumed && options.resumed->frame ? options.resumed->frame->world_edition : 0;
}

// Wall times, s.
constexpr double kAnnouncePeriod = 0.5;  // of a session whose agents have another service

constexpr double kUsualDelay = 0.2;  // s of wall time for which a missing proposal is not reported
constexpr std::size_t kSlowestListed = 5;

}  // namespace

TickCoordinator::TickCoordinator(const std::shared_ptr<const Scene>& scene, const CoordinatorOptions& options,
                                 ServiceEndpoint& endpoint, RunObservers observers, double now)
    : run_{.options = options,
           .endpoint = endpoint,
           .observers = std::move(observers),
           .created_at = now,
           .scene = scene,
           .members = Membership(scene->world(), options.lease_seconds, WorldEditionOf(options))},
      engine_(run_, now),
      editor_(run_, engine_),
      control_(run_, engine_, editor_),
      statistics_(run_, engine_, editor_, now),
      progress_at_(now) {
  if (run_.realtime()) {
    run_.notices.Add("mode realtime does not wait for late robots: two runs of it are not the same");
    if (!options.settings.pace()) {
      run_.notices.Add("mode realtime needs a pace: without --speed X, and with --speed max, it is 1 x real time");
    }
  }
}

std::optional<double> TickCoordinator::startup_seconds() const {
  if (!run_.started_at) return std::nullopt;
  return *run_.started_at - run_.created_at;
}

void TickCoordinator::OnJoin(const JoinMessage& join, double now) {
  // Without an answer: the agent learns the run from the session, and joins again.
  if (join.run != run_.options.run || join.incarnation != run_.options.incarnation) return;
  if (run_.phase == Phase::kOver) return;
  // An agent that is started again at the end of a run leaves with the others.
  if (run_.phase == Phase::kEnding) return run_.endpoint.SendFrame(run_.frame);
  if (run_.phase == Phase::kGathering && join.memory &&
      *join.memory == ControllerCheckpoint{run_.frame.edition, run_.frame.state.tick, true}) {
    // So the service before had released this frame: it is not shown to observers a second time (TickEngine::Continue).
    run_.is_decided = true;
  }
  std::optional<HistoryRequest> missing;
  if (run_.restores_memory()) missing = run_.memories.MissingFor(join, run_.frame);
  const JoinDecision decision = run_.members.Join(join, run_.next_place(), now, missing.has_value());
  switch (decision.outcome) {
    case JoinDecision::Outcome::kUndecided:
      return;
    case JoinDecision::Outcome::kBehind:
      return DemandHistory(join, *missing, now);
    case JoinDecision::Outcome::kRefused:
    case JoinDecision::Outcome::kRepeated:
      return AnswerJoin(join, decision);
    case JoinDecision::Outcome::kAdmitted:
      AnswerJoin(join, decision);
      engine_.AddMember(*decision.member, now);
      editor_.OnJoined(decision.member->robots);
      NoteGoals(join);
      if (run_.phase == Phase::kGathering && all_have_joined()) return Begin(now);
      if (run_.phase == Phase::kRunning) run_.endpoint.SendFrame(run_.frame);  // sent before this agent was there
      return;
  }
}

void TickCoordinator::NoteGoals(const JoinMessage& join) {
  const std::vector<std::optional<RobotId>> robots = FindRobots(run_.world(), join.robots);
  const std::set<std::string_view> accepting(join.accept_goals.begin(), join.accept_goals.end());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!robots[i]) continue;
    // By the name of the controller, not by robot: a robot that is spawned later has the answer before its agent joins.
    run_.accepts_goals[run_.world().robot(*robots[i]).controller.name] = accepting.contains(join.robots[i]);
  }
}

void TickCoordinator::DemandHistory(const JoinMessage& join, const HistoryRequest& request, double now) {
  // An agent that is still reading its history is a sign of progress: the run waits longer for all to join.
  progress_at_ = now;
  engine_.AwaitAgent(now);
  const auto same = [&](const HistoryDemand& demand) {
    return demand.request == request && demand.after == join.memory;
  };
  auto demand = std::find_if(demands_.begin(), demands_.end(), same);
  if (demand == demands_.end()) demand = demands_.insert(demands_.end(), {request, join.memory, {}, now});
  std::vector<AgentId>& agents = demand->agents;
  if (std::find(agents.begin(), agents.end(), join.agent) == agents.end()) agents.push_back(join.agent);
}

std::vector<TickCoordinator::HistoryDemand> TickCoordinator::DrainHistoryDemands(double now) {
  const auto is_due = [now](const HistoryDemand& demand) { return now >= demand.since + kHistoryDelay; };
  std::vector<HistoryDemand> due;
  std::copy_if(demands_.begin(), demands_.end(), std::back_inserter(due), is_due);
  std::erase_if(demands_, is_due);
  return due;
}

// Agents that join before the run begins are admitted together when it does.
void TickCoordinator::AnswerJoin(const JoinMessage& join, const JoinDecision& decision) {
  const bool admitted = decision.outcome != JoinDecision::Outcome::kRefused;
  if (admitted && run_.phase == Phase::kGathering) return;
  run_.endpoint.SendAdmissions({MakeAdmission(run_, join.agent, admitted, decision.reason, decision.taken)});
}

void TickCoordinator::Begin(double now) {
  statistics_.OnBegin(now);
  engine_.Begin(now);
  control_.Advance(now);
}

void TickCoordinator::OnProposal(const ProposalMessage& proposal, double now, const SharedProposal& shared) {
  engine_.OnProposal(proposal, now, shared);
  control_.Advance(now);
}

void TickCoordinator::OnAgentGone(AgentId agent, double now) {
  engine_.OnAgentGone(agent, "it ended", now);
  control_.Advance(now);
}

void TickCoordinator::OnAgentSilent(AgentId agent, double now) {
  engine_.OnAgentSilent(agent, now);
  control_.Advance(now);
}

void TickCoordinator::OnAgentNews(const AgentNews& news, double now) {
  if (news.end.empty()) return engine_.Supervise(news.agent);
  engine_.OnAgentGone(news.agent, PlainLine(news.end, kMaxHost), now);
  control_.Advance(now);
}

void TickCoordinator::OnRivalService(const SessionMessage& rival, double now) {
  if (rival.run == run_.options.run) return OnOtherService(rival, now);
  if (run_.started_at && !rival.begun) Announce();  // for the rival, which cannot know that this run has begun
  const std::string process = PlainLine(rival.host, kMaxHost) + ", pid " + std::to_string(rival.pid);
  if (run_.phase == Phase::kGathering && (rival.begun || rival.run < run_.options.run)) {
    return Fail(Failure("another world service runs in this session (" + process + "); use another session name"), now);
  }
  // A rival repeats its session; people need one line.
  if (rival.run == known_rival_) return;
  known_rival_ = rival.run;
  run_.notices.Add("another world service has entered this session (" + process + "); this one continues");
}

// If a run has two services, the later one continues it.
void TickCoordinator::OnOtherService(const SessionMessage& other, double now) {
  // The other is the older one, for instance a process that was stopped and continued: the session tells it to end.
  if (other.incarnation < run_.options.incarnation) return Announce();
  if (other.incarnation == run_.options.incarnation) return;
  Fail(Failure("another world service (" + PlainLine(other.host, kMaxHost) + ", pid " + std::to_string(other.pid) +
               ") continues this run"),
       now);
}

void TickCoordinator::Poll(double now) {
  if (run_.phase == Phase::kGathering) return PollGathering(now);
  // Before the engine's own poll: a barrier without the lost member may be complete now.
  engine_.WatchSilentMembers(now);
  control_.Advance(now);
  if (run_.phase == Phase::kRunning) GiveUpNewRobots(now);
  engine_.Poll(now);
  control_.Advance(now);
}

void TickCoordinator::Wake(double now) {
  engine_.Wake(now);
  Poll(now);
}

void TickCoordinator::PollGathering(double now) {
  if (all_have_joined()) return Begin(now);
  if (run_.takes_over()) return PollRejoining(now);
  const double timeout = run_.options.start_timeout_seconds;
  if (timeout <= 0.0 || now - progress_at_ < timeout) return;
  std::string text = "no agent joined for " + ListNames(run_.world(), run_.members.AbsentRobots()) + " within " +
                     std::to_string(static_cast<int>(timeout)) + " s";
  // Of several agents that join, some may miss what is sent to all of them.
  if (!run_.options.advice_on_silence.empty()) text += "; " + run_.options.advice_on_silence;
  Fail(Failure(std::move(text)), now);
}

bool TickCoordinator::all_have_joined() const {
  if (run_.members.all_robots_present()) return true;
  if (!run_.takes_over()) return false;
  // Robots that had no agent before are not waited for: the run went on without them, too.
  const std::vector<RobotId>& absent_before = run_.options.resumed->progress.absent;
  const std::vector<RobotId> absent = run_.members.AbsentRobots();
  return run_.members.present_members() > 0 &&
         std::includes(absent_before.begin(), absent_before.end(), absent.begin(), absent.end());
}

// Agents that do not rejoin in time are lost, as with a service that was not restarted.
void TickCoordinator::PollRejoining(double now) {
  if (now >= announced_at_ + kAnnouncePeriod) {
    announced_at_ = now;
    Announce();
  }
  if (now < RejoinDeadline()) return;
  if (engine_.IsLast(run_.frame.state)) return Begin(now);
  for (const RobotId robot : run_.members.AbsentRobots()) {
    run_.events.Add(EventType::kLeft, run_.frame.state.tick, robot, "its agent has not rejoined the run");
  }
  Begin(now);
  if (run_.options.settings.on_agent_loss != OnAgentLoss::kAbort) return;
  Fail(Failure("the agents of " + ListNames(run_.world(), run_.members.AbsentRobots()) + " have not rejoined the run"),
       now);
}

double TickCoordinator::RejoinDeadline() const {
  const RunSettings& settings = run_.options.settings;
  // The agents may all have left, because they have seen the last frame.
  if (engine_.IsLast(run_.frame.state)) return run_.created_at + 2.0 * run_.options.lease_seconds;
  const double longest =
      settings.agent_deadline_seconds > 0.0 ? settings.agent_deadline_seconds : run_.options.start_timeout_seconds;
  return longest > 0.0 ? progress_at_ + longest : std::numeric_limits<double>::infinity();
}

void TickCoordinator::GiveUpNewRobots(double now) {
  const Status in_time = editor_.CheckTimeout(now);
  if (in_time.ok()) return;
  control_.GiveUpNewRobots(in_time.error(), now);
  control_.Advance(now);
}

double TickCoordinator::NextPoll() const {
  double next = std::numeric_limits<double>::infinity();
  for (const HistoryDemand& demand : demands_) next = std::min(next, demand.since + kHistoryDelay);
  if (run_.phase != Phase::kGathering) return std::min(next, engine_.NextPoll());
  if (all_have_joined()) return run_.created_at;
  if (run_.takes_over()) return std::min({next, announced_at_ + kAnnouncePeriod, RejoinDeadline()});
  return next;
}

void TickCoordinator::Control(const control::Request& request, ControlReplyTo reply, double now, RequestedWorld world) {
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

std::vector<std::string> RunStatistics::MissingRobots(double now) const {
  const bool running = run_.phase == RunPhase::kRunning;
  const bool all_absent = run_.phase == RunPhase::kGathering || (running && engine_.halted());
  std::vector<RobotId> robots = all_absent ? run_.members.AbsentRobots() : editor_.robots_without_agent();
  if (running && now - engine_.committed_at() > kUsualDelay) {
    for (AgentId agent : engine_.MissingMembers()) {
      const std::vector<RobotId>& of_agent = run_.members.member(agent).robots;
      robots.insert(robots.end(), of_agent.begin(), of_agent.end());
    }
  }
  std::sort(robots.begin(), robots.end());
  std::vector<std::string> names;
  for (RobotId robot : robots) names.push_back(run_.world().robot(robot).name);
  if (running && now - engine_.committed_at() > kUsualDelay) {
    names.insert(names.end(), engine_.awaited().begin(), engine_.awaited().end());
  }
  return names;
}

StatusMessage RunStatistics::MakeStatus(double now) {
  const double interval = run_.world().interval_seconds();
  StatusMessage status;
  status.run = run_.options.run;
  status.tick = run_.frame.state.tick;
  status.target_ticks = run_.options.settings.ticks.value_or(0);
  status.sim_seconds = static_cast<double>(status.tick) * interval;
  status.robots = static_cast<std::uint32_t>(run_.members.robots());
  status.agents = static_cast<std::uint32_t>(run_.members.present_members());
  status.edition = run_.frame.edition;
  status.incarnation = run_.options.incarnation;
  status.speed = engine_.speed();
  if (const PhaseTimes* const times = run_.options.phase_times; times != nullptr) {
    status.phases = {times->Mean(TickPhase::kWait), times->Mean(TickPhase::kStep), times->Mean(TickPhase::kRecord),
                     times->Mean(TickPhase::kPublish)};
  }
  status.waiting_for = MissingRobots(now);
  if (!status.waiting_for.empty()) {
    status.waiting_seconds = now - (run_.phase == RunPhase::kGathering ? run_.created_at : engine_.committed_at());
  }
  if (run_.started_at) status.wall_seconds = now - *run_.started_at;
  if (now > status_at_) {
    status.real_time_factor = static_cast<double>(engine_.steps() - status_steps_) * interval / (now - status_at_);
  }
  status_at_ = now;
  status_steps_ = engine_.steps();
  return status;
}

RunSummary RunStatistics::MakeSummary() const {
  const double interval = run_.world().interval_seconds();
  RunSummary summary;
  summary.ticks = run_.frame.state.tick;
  summary.sim_seconds = static_cast<double>(summary.ticks) * interval;
  if (run_.started_at) {
    summary.startup_seconds = *run_.started_at - run_.created_at;
    summary.wall_seconds = engine_.committed_at() - *run_.started_at;
  }
  if (summary.wall_seconds > 0.0) {
    summary.real_time_factor = static_cast<double>(engine_.steps()) * interval / summary.wall_seconds;
  }
  summary.robots = static_cast<std::uint32_t>(run_.members.robots());
  summary.stalls = run_.events.stalls();
  summary.rejected = run_.events.rejected();
  summary.frames_repeated = engine_.frames_resent();
  summary.state_hash = run_.frame.state_hash;
  summary.slowest = SlowestRobots();
  for (RunObserver* observer : run_.observers) {
    for (SlowRobot& slow : observer->SlowestAwaited()) summary.ros.push_back(std::move(slow));
  }
  summary.lost = run_.lost_robots;
  summary.frozen = engine_.frozen_robots();
  summary.interrupted = run_.interrupted;
  summary.record_waited_seconds = engine_.observers_waited_seconds();
  return summary;
}

std::vector<SlowRobot> RunStatistics::SlowestRobots() const {
  std::vector<SlowRobot> slowest;
  const std::vector<Membership::Waits> waits = run_.members.RobotWaits();
  for (std::size_t i = 0; i < waits.size(); ++i) {
    if (waits[i].times_last == 0) continue;
    slowest.push_back({run_.world().robots[i].name, waits[i].times_last, waits[i].waited_seconds});
  }
  std::stable_sort(slowest.begin(), slowest.end(),
                   [](const SlowRobot& a, const SlowRobot& b) { return a.waited_seconds > b.waited_seconds; });
  if (slowest.size() > kSlowestListed) slowest.resize(kSlowestListed);
  return slowest;
}

}  // namespace troupe
