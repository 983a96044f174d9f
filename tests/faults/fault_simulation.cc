#include "tests/faults/fault_simulation.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/model/states.h"
#include "transport/dds/convert/convert.h"
#include "troupe/event.h"

namespace troupe::faults {
namespace {

using Phase = TickCoordinator::Phase;

constexpr RunId kRun = 1;
constexpr double kMaxWait = 0.05;             // s, as RunService
constexpr double kMaxRecovery = 60;           // s, from the last fault to a run that is whole again
constexpr std::size_t kMaxEvents = 2000;      // in the queue, and waiting for a stopped process
constexpr double kMaxGap = 3.0;               // s, of the frames that an observer shows, with messages lost
constexpr double kMaxRequest = 0.01;          // s, from a tool to the service
constexpr std::uint64_t kMaxSteps = 500'000;  // events of a run
constexpr std::size_t kMaxReports = 200;      // events or notices between two reports of the service

CoordinatorOptions MakeCoordinatorOptions(const FaultPlan& plan) {
  return {.settings = plan.settings,
          .run = kRun,
          .lease_seconds = plan.lease,
          .start_timeout_seconds = plan.start_timeout,
          .start_paused = plan.start_paused,
          .host = "service"};
}

}  // namespace

FaultSimulation::FaultSimulation(const FaultPlan& plan, std::function<void(const std::string&)> log)
    : plan_(plan),
      log_(std::move(log)),
      network_(events_, plan.messages, plan.lease, plan.seed),
      random_(plan.seed, 3),
      scene_(std::make_shared<const Scene>(RunWorld(plan.robots, plan.memory))),
      reference_(scene_, plan_),
      journal_(scene_),
      restarts_(plan_.restarts) {}

template <typename... Parts>
void FaultSimulation::Log(fmt::format_string<Parts...> format, Parts&&... parts) {
  if (log_) log_(fmt::format("{:8.3f} ", events_.now()) + fmt::format(format, std::forward<Parts>(parts)...));
}

SimulationResult FaultSimulation::Run() {
  MakeCoordinator();
  CallService([this](double) { coordinator_->Announce(); });
  std::vector<std::string> robots;
  for (const RobotDescription& robot : scene_->world().robots) robots.push_back(robot.name);
  Launch(robots, 0.2);
  for (const ProcessFault& fault : plan_.faults) {
    events_.At(fault.at, [this, fault] { Inject(fault); });
  }
  for (const PlannedRequest& request : plan_.requests) {
    events_.At(request.at, [this, request] { SendRequest(request.request); });
  }
  for (const PlannedObserver& observer : plan_.observers) {
    events_.At(observer.joins_at, [this, observer] { AddObserver(observer); });
  }
  RunWithFaults();
  if (violation_.empty()) CheckRecovery();
  if (violation_.empty()) CheckEnd();
  return {violation_, reference_.ticks(), reference_.hash(), events_.now(), lost_};
}

void FaultSimulation::RunWithFaults() {
  while (violation_.empty() && events_.Advance(plan_.faults_end)) CheckMemory();
}

template <typename Condition>
bool FaultSimulation::Await(const Condition& condition, double seconds) {
  const double end = events_.now() + seconds;
  while (violation_.empty() && !condition()) {
    if (!events_.Advance(end)) return condition();
    CheckMemory();
  }
  return true;
}

void FaultSimulation::CheckRecovery() {
  Await([] { return false; }, kMaxRequest);  // all requests have arrived
  journal_.SetOnCommit(nullptr);
  Await([this] { return !returning_; }, 10.0);
  if (!service_runs()) return;
  SendRequest(control::Play());
  const double owner_looks = 1.0;
  const double end = events_.now() + kMaxRecovery;
  while (violation_.empty() && service_runs()) {
    StartMissingAgents();
    if (Await([this] { return !service_runs() || IsConsistent(); }, owner_looks)) break;
    if (events_.now() >= end) return Violate("the run does not recover: " + DescribeInconsistency());
  }
  const Tick target = reference_.ticks() + 3;
  const bool advances = Await([&] { return !service_runs() || reference_.ticks() >= target; }, kMaxRecovery);
  if (!advances) return Violate("the barrier is stalled: " + DescribeInconsistency());
  const Edition edition = reference_.edition();
  const Tick tick = reference_.tick();
  if (!Await([&] { return !service_runs() || ObserversHaveShown(edition, tick); }, kMaxGap)) {
    Violate(fmt::format("an observer does not show tick {} of edition {}", tick, edition));
  }
}

void FaultSimulation::CheckEnd() {
  if (service_runs()) {
    network_.RunInside(kService, [this] { CallService([this](double now) { coordinator_->Stop(now); }); });
    if (!Await([this] { return !service_runs(); }, 5.0)) return Violate("the service does not end");
  }
  const double longest = plan_.session_timeout + 2.0 * plan_.lease + 5.0;
  if (!Await([this] { return LivingAgents().empty(); }, longest)) {
    return Violate(fmt::format("agent {} does not end", LivingAgents().front()->id()));
  }
  CheckRequests();
}

void FaultSimulation::CheckRequests() {
  for (const SentRequest& request : requests_) {
    const bool must_be_answered = request.arrived && !request.lost && !plan_.service_dies;
    if (request.replies > 1 || (must_be_answered && request.replies == 0)) {
      return Violate(fmt::format("a request (command {}) has {} replies", request.kind, request.replies));
    }
  }
}

void FaultSimulation::CheckMemory() {
  if (++steps_ > kMaxSteps) return Violate("the time does not advance");
  if (events_.size() > kMaxEvents || network_.most_waiting() > kMaxEvents) {
    Violate(fmt::format("{} events wait, and {} messages for a process", events_.size(), network_.most_waiting()));
  }
}

bool FaultSimulation::IsConsistent() const {
  return DescribeInconsistency().empty();
}

std::string FaultSimulation::DescribeInconsistency() const {
  if (coordinator_->phase() != Phase::kRunning) return "the run has not begun";
  for (const SentRequest& request : requests_) {
    if (request.arrived && !request.lost && request.replies == 0) return "a request waits for its reply";
  }
  if (coordinator_->frame().paused) return "the run is paused";
  const std::vector<SimulatedAgent*> living = LivingAgents();
  std::set<std::string> robots;
  for (const SimulatedAgent* agent : living) {
    if (!agent->protocol().is_running()) return fmt::format("agent {} is not admitted", agent->id());
    const std::vector<std::string> names = agent->protocol().RobotNames();
    robots.insert(names.begin(), names.end());
  }
  const WorldDescription& world = coordinator_->scene()->world();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i)) && !robots.contains(world.robots[i].name)) {
      return "no agent runs for " + world.robots[i].name;
    }
  }
  if (coordinator_->present_agents() != living.size()) {
    return fmt::format("the service has {} agents, of {}", coordinator_->present_agents(), living.size());
  }
  return {};
}

void FaultSimulation::Violate(const std::string& text) {
  if (violation_.empty()) violation_ = fmt::format("at {:.3f} s: {}", events_.now(), text);
}

// The service's process.

void FaultSimulation::MakeCoordinator() {
  CoordinatorOptions options = MakeCoordinatorOptions(plan_);
  std::shared_ptr<const Scene> scene = scene_;
  if (returning_) {
    options.resumed = journal_.Resume(kRun);
    options.incarnation = options.resumed->incarnation;
    scene = options.resumed->scene;
    journal_.SetIncarnation(options.incarnation);
  }
  coordinator_.emplace(scene, options, static_cast<ServiceEndpoint&>(*this), RunObservers{&journal_, &reference_},
                       events_.now());
}

void FaultSimulation::CallService(const std::function<void(double now)>& call) {
  if (!service_runs()) return;
  call(events_.now());
  if (!dies_in_commit_) ActAsService();
  if (dies_in_commit_) KillService();
}

void FaultSimulation::KillService() {
  if (!service_runs()) return;
  Log("service: dies");
  network_.Kill(kService);
  dies_in_commit_ = false;
  journal_.SetOnCommit(nullptr);
  for (SentRequest& request : requests_) request.lost = request.arrived && request.replies == 0;
  if (!plan_.service_returns) return;
  returning_ = true;
  events_.After(random_.Uniform(0.02, 1.5 * plan_.lease), [this] { ReturnService(); });
}

void FaultSimulation::ReturnService() {
  Log("service: returns");
  stream_ = {};
  session_ = nullptr;
  wake_at_ = -1.0;
  ++wake_;
  MakeCoordinator();
  returning_ = false;
  network_.ReplaceService();
  CallService([this](double) { coordinator_->Announce(); });
}

void FaultSimulation::ActAsService() {
  coordinator_->Poll(events_.now());
  if (dies_in_commit_) return;
  if (!reference_.difference().empty()) return Violate(reference_.difference());
  if (!coordinator_->error().ok()) return Violate("the run fails: " + coordinator_->error().error().message);
  const std::vector<Event> reports = coordinator_->DrainEvents();
  for (const Event& event : reports) {
    Log("service: tick {}: {} {}", event.tick, NameOf(event.type), event.detail);
    if (event.type != EventType::kLeft) continue;
    ++lost_;
    if (plan_.gentle) return Violate("an agent is lost: " + event.detail);
  }
  const std::vector<std::string> notices = coordinator_->DrainNotices();
  for (const std::string& notice : notices) Log("service: {}", notice);
  if (reports.size() > kMaxReports || notices.size() > kMaxReports) return Violate("too many reports");
  const std::vector<std::string> robots = coordinator_->DrainNewRobots();
  const Edition edition = coordinator_->frame().edition;
  if (!robots.empty() && edition > launched_edition_) {  // not reported before, by a service that died
    launched_edition_ = edition;
    Launch(robots, 0.3);
  }
  if (coordinator_->phase() == Phase::kOver) {
    Log("service: ends");
    return network_.End(kService);
  }
  WakeService(std::clamp(coordinator_->NextPoll(), events_.now(), events_.now() + kMaxWait));
}

void FaultSimulation::WakeService(double time) {
  if (wake_at_ >= events_.now() && wake_at_ <= time) return;
  wake_at_ = time;
  events_.At(time, [this, wake = ++wake_] {
    network_.RunInside(kService, [this, wake] {
      if (wake != wake_) return;
      wake_at_ = -1.0;
      CallService([](double) {});
    });
  });
}

void FaultSimulation::SendSession(const SessionMessage& session) {
  if (dies_in_commit_) return;
  session_ = std::make_shared<const SessionMessage>(session);
  for (const auto& [id, agent] : agents_) DeliverSession(id);
  for (const auto& [id, observer] : observers_) DeliverSession(id);
}

void FaultSimulation::DeliverSession(ProcessId agent) {
  if (session_ == nullptr || session_sent_[agent] == session_) return;
  const auto deliver = [this, agent, session = session_] {
    session_received_[agent] = true;
    if (const auto observer = observers_.find(agent); observer != observers_.end()) {
      return observer->second->OnSession(*session);
    }
    ToAgent(agent, [session](AgentProtocol& protocol) { protocol.OnSession(*session); });
  };
  if (network_.SendIntact(kService, agent, deliver)) session_sent_[agent] = session_;
}

void FaultSimulation::SendAdmissions(const std::vector<AdmissionMessage>& admissions) {
  if (dies_in_commit_) return;
  const auto shared = std::make_shared<const std::vector<AdmissionMessage>>(admissions);
  for (const auto& [id, agent] : agents_) {
    network_.Send(kService, id, [this, id = id, shared] {
      ToAgent(id, [shared](AgentProtocol& protocol) {
        for (const AdmissionMessage& admission : *shared) protocol.OnAdmission(admission);
      });
    });
  }
}

void FaultSimulation::SendFrame(const FrameMessage& frame) {
  if (dies_in_commit_) return;
  Log("service: frame {} of edition {} ({}){}{}", frame.state.tick, frame.edition, frame.world_edition,
      frame.paused ? ", paused" : "", frame.last ? ", last" : "");
  const auto shared = std::make_shared<const FrameMessage>(frame);
  for (const auto& [id, agent] : agents_) {
    network_.Send(kService, id, [this, id = id, shared] {
      ToAgent(id, [this, shared](AgentProtocol& protocol) { protocol.OnFrame(*shared, events_.now()); });
    });
  }
  SendToObservers(frame, stream_.BaseOf(frame), false);
  stream_.Sent(frame);
}

void FaultSimulation::SendHistory(const HistoryMessage& history) {
  const auto shared = std::make_shared<const HistoryMessage>(history);
  for (const auto& [id, agent] : agents_) {
    network_.Send(kService, id, [this, id = id, shared] {
      ToAgent(id, [shared](AgentProtocol& protocol) { protocol.OnHistory(*shared); });
    });
  }
}

void FaultSimulation::SendRequest(const control::Request& request) {
  const std::size_t index = requests_.size();
  requests_.push_back({.kind = request.index()});
  events_.After(random_.Uniform(0.0, kMaxRequest), [this, request, index] {
    network_.RunInside(kService, [this, request, index] {
      requests_[index].arrived = true;
      Log("tool: request {}, {}", index, std::visit([](const auto& each) { return each.kName; }, request));
      RequestedWorld world;
      if (control::Is<control::LoadWorld>(request)) world = {OtherWorld(plan_.memory)};
      const auto* const spawn = std::get_if<control::Spawn>(&request);
      if (spawn != nullptr) world = {WorldToSpawn(spawn->source, plan_.memory)};
      const auto reply = [this, index](const ControlReply& content) {
        ++requests_[index].replies;
        Log("tool: reply to request {}: {}", index, content.done ? "done" : content.problem);
      };
      CallService([&](double now) { coordinator_->Control(request, reply, now, world); });
    });
  });
}

// The launcher.

void FaultSimulation::Launch(const std::vector<std::string>& robots, double longest_delay) {
  for (std::size_t i = 0; i < robots.size(); i += plan_.packing) {
    const auto begin = robots.begin() + static_cast<std::ptrdiff_t>(i);
    const auto count = static_cast<std::ptrdiff_t>(std::min(plan_.packing, robots.size() - i));
    groups_.push_back({.robots = {begin, begin + count}, .joins_late = launched_edition_ > 0});
    const std::size_t group = groups_.size() - 1;
    ++launching_;
    events_.After(random_.Uniform(0.0, longest_delay), [this, group] {
      --launching_;
      StartAgent(group);
    });
  }
}

void FaultSimulation::StartAgent(std::size_t group) {
  if (!run_goes_on()) return;
  const ProcessId id = NewProcess();
  AgentOptions options{.agent = id, .robots = groups_[group].robots};
  options.skip_unavailable = std::exchange(groups_[group].joins_late, true);
  options.libraries.Add(kCountingController);
  options.session_timeout_seconds = plan_.session_timeout;
  Log("agent {}: starts for {}", id, fmt::join(options.robots, ", "));
  AddAgent(id, options, group);
}

void FaultSimulation::AddAgent(ProcessId id, const AgentOptions& options, std::size_t group) {
  SimulatedAgent::Outputs outputs;
  outputs.send_join = [this, id](const JoinMessage& join) {
    Log("agent {}: joins edition {}", id, join.world_edition);
    network_.SendWithPresence(id, kService, [this, id, join] {
      join_received_[id] = true;
      CallService([&](double now) { coordinator_->OnJoin(join, now); });
    });
  };
  outputs.send_proposal = [this, id](const ProposalMessage& proposal) {
    network_.Send(id, kService,
                  [this, proposal] { CallService([&](double now) { coordinator_->OnProposal(proposal, now); }); });
  };
  outputs.on_end = [this, id, group](int exit_status) {
    const Status& failure = agents_.at(id)->protocol().failure();
    const std::string reason = failure.ok() ? "" : failure.error().message;
    Log("agent {}: ends, {} {}", id, exit_status, reason);
    // Afterwards the owner may start a second one.
    const bool is_needed = plan_.only_deaths && events_.now() <= plan_.faults_end;
    if (is_needed && reason.find("has an agent already") != std::string::npos) Violate(reason);
    network_.End(id);
    OnAgentEnd(group, exit_status);
  };
  agents_[id] = std::make_unique<SimulatedAgent>(events_, network_, options, std::move(outputs));
  Network::Handlers at_agent;
  at_agent.on_discovered = [this, id] {
    session_sent_[id] = nullptr;
    DeliverSession(id);
  };
  at_agent.on_open = [this, id] { DeliverSession(id); };
  const auto if_known = [this, id](void (AgentProtocol::*call)(double)) {
    if (std::exchange(session_received_[id], false)) {
      ToAgent(id, [this, call](AgentProtocol& protocol) { (protocol.*call)(events_.now()); });
    }
  };
  at_agent.on_lost = [if_known] { if_known(&AgentProtocol::OnServiceLost); };
  at_agent.on_ended = [if_known] { if_known(&AgentProtocol::OnServiceGone); };
  Network::Handlers at_service;
  at_service.on_discovered = [this, id] {
    const JoinMessage* join = agents_.at(id)->newest_join();
    if (join == nullptr) return;
    network_.SendIntact(id, kService, [this, id, copy = *join] {
      join_received_[id] = true;
      CallService([&](double now) { coordinator_->OnJoin(copy, now); });
    });
  };
  at_service.on_open = [] {};
  at_service.on_lost = at_service.on_ended = [this, id] {
    if (!std::exchange(join_received_[id], false)) return;
    CallService([&](double now) { coordinator_->OnAgentGone(id, now); });
  };
  network_.AddAgent(id, std::move(at_agent), std::move(at_service));
}

void FaultSimulation::OnAgentEnd(std::size_t group, int exit_status) {
  if (run_goes_on() && restarts_.OnEnd(group, exit_status, events_.now())) AwaitRestarts();
}

void FaultSimulation::AwaitRestarts() {
  const std::optional<double> due = restarts_.NextDue();
  if (due) events_.At(std::max(events_.now(), *due), [this] { RestartAgents(); });
}

void FaultSimulation::RestartAgents() {
  if (!run_goes_on()) return restarts_.Cancel();
  for (const AgentRestarts::Agent group : restarts_.DrainDue(events_.now())) {
    // The process needs some time to start.
    events_.After(random_.Uniform(0.02, 0.2), [this, group] { StartAgent(group); });
  }
  AwaitRestarts();
}

// Observers.

void FaultSimulation::AddObserver(const PlannedObserver& plan) {
  if (!service_runs()) return;
  const ProcessId id = NewProcess();
  Log("observer {}: starts", id);
  SimulatedObserver::Outputs outputs;
  outputs.send_request = [this, id] { network_.Send(id, kService, [this] { OnRequestOfObserver(); }); };
  outputs.on_frame = [this, id](const FrameMessage& frame) { CheckShown(id, frame); };
  outputs.on_problem = [this, id](const std::string& problem) {
    Violate(fmt::format("observer {}: a malformed frame: {}", id, problem));
  };
  observers_[id] = std::make_unique<SimulatedObserver>(events_, network_, id, std::move(outputs));
  Network::Handlers at_observer;
  at_observer.on_discovered = [this, id] {
    session_sent_[id] = nullptr;
    DeliverSession(id);
  };
  at_observer.on_open = [this, id] { DeliverSession(id); };
  at_observer.on_lost = at_observer.on_ended = [this, id] { observers_.at(id)->OnServiceGone(); };
  const auto nothing = [] {};
  network_.AddAgent(id, std::move(at_observer), {nothing, nothing, nothing, nothing});
  if (plan.stopped_seconds > 0.0) {
    events_.At(plan.stops_at, [this, id] { network_.Stop(id); });
    events_.At(plan.stops_at + plan.stopped_seconds, [this, id] { network_.Continue(id); });
  }
  if (plan.dies_at) events_.At(*plan.dies_at, [this, id] { network_.Kill(id); });
}

void FaultSimulation::OnRequestOfObserver() {
  if (!service_runs()) return;
  if (const FrameMessage* frame = stream_.AnswerRequest(events_.now())) SendToObservers(*frame, nullptr, true);
}

void FaultSimulation::SendToObservers(const FrameMessage& frame, const WorldState* base, bool requested) {
  if (observers_.empty()) return;
  struct Sample {
    dds::WireArena arena;
    troupe_wire_Frame wire{};
  };
  const auto sample = std::make_shared<Sample>();
  sample->wire = dds::ToWire(frame, base, sample->arena);
  for (const auto& [id, observer] : observers_) {
    network_.Send(kService, id,
                  [&observer = *observer, sample, requested] { observer.OnFrame(sample->wire, requested); });
  }
}

void FaultSimulation::CheckShown(ProcessId observer, const FrameMessage& frame) {
  const std::optional<std::uint64_t> hash = reference_.HashOf(frame.edition, frame.state.tick);
  if (!hash || StateHash(frame.state) != *hash) {
    Violate(fmt::format("observer {} shows a wrong state of tick {} of edition {}", observer, frame.state.tick,
                        frame.edition));
  }
}

bool FaultSimulation::ObserversHaveShown(Edition edition, Tick tick) const {
  return std::all_of(observers_.begin(), observers_.end(), [&](const auto& observer) {
    return network_.HasEnded(observer.first) || observer.second->HasShown(edition, tick);
  });
}

void FaultSimulation::StartMissingAgents() {
  if (launching_ > 0) return;
  std::set<std::string> robots;
  for (const SimulatedAgent* agent : LivingAgents()) {
    const AgentProtocol& protocol = agent->protocol();
    const std::vector<std::string> names = protocol.is_running() ? protocol.RobotNames() : agent->robots();
    robots.insert(names.begin(), names.end());
  }
  const WorldDescription& world = coordinator_->scene()->world();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const std::string& name = world.robots[i].name;
    if (RobotExists(world, RobotId(i)) && !robots.contains(name)) Launch({name}, 0.0);
  }
}

std::vector<SimulatedAgent*> FaultSimulation::LivingAgents() const {
  std::vector<SimulatedAgent*> living;
  for (const auto& [id, agent] : agents_) {
    if (!network_.HasEnded(id)) living.push_back(agent.get());
  }
  return living;
}

void FaultSimulation::ToAgent(ProcessId agent, std::function<void(AgentProtocol&)> call) {
  agents_.at(agent)->Call(call);
}

// Faults.

void FaultSimulation::Inject(const ProcessFault& fault) {
  if (fault.victim == 0) return InjectInto(kService, fault);
  const std::vector<SimulatedAgent*> living = LivingAgents();
  if (living.empty()) return;
  if (!fault.all_agents) return InjectInto(living[fault.victim % living.size()]->id(), fault);
  for (const SimulatedAgent* agent : living) InjectInto(agent->id(), fault);
}

void FaultSimulation::InjectInto(ProcessId victim, const ProcessFault& fault) {
  Log("process {}: fault {} for {:.3f} s", victim, static_cast<int>(fault.kind), fault.seconds);
  const auto later = [&](auto call) { events_.After(fault.seconds, std::move(call)); };
  switch (fault.kind) {
    case FaultKind::kStop:
      network_.Stop(victim);
      return later([this, victim] { network_.Continue(victim); });
    case FaultKind::kKill:
      if (victim == kService) return KillService();
      network_.Kill(victim);
      for (std::size_t group = 0; group < groups_.size(); ++group) {
        if (groups_[group].robots != agents_.at(victim)->robots()) continue;
        return OnAgentEnd(group, 128 + 9);
      }
      return;
    case FaultKind::kKillInCommit:
      return journal_.SetOnCommit([this] { dies_in_commit_ = true; });
    case FaultKind::kPartition:
    case FaultKind::kPartitionTo:
    case FaultKind::kPartitionFrom:
      break;
  }
  const bool to = fault.kind != FaultKind::kPartitionFrom;
  const bool from = fault.kind != FaultKind::kPartitionTo;
  if (to) network_.BlockToAgent(victim, true);
  if (from) network_.BlockFromAgent(victim, true);
  later([this, victim, to, from] {
    if (to) network_.BlockToAgent(victim, false);
    if (from) network_.BlockFromAgent(victim, false);
  });
}

}  // namespace troupe::faults
