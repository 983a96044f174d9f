#include "viewer/module/page_run.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "common/base/identity.h"
#include "robot-agent/agent/agent_protocol.h"
#include "robot-agent/controller/create_controller.h"
#include "world-service/service/requested_file.h"

namespace troupe {
namespace {

// Wall times, s.
constexpr double kStatusPeriod = 0.5;
constexpr double kNever = 1e9;  // a page may sleep for any time, and loses no agent by that

// Wall time, s.
double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

// Observers are called at once, agents by the queue: a page must not be behind its own run.
class PageRun::Service final : public ServiceEndpoint {
 public:
  explicit Service(PageRun& run) : run_(run) {}

  void Start(ServiceHandler& /*handler*/) override {}
  void SendSession(const SessionMessage& session) override;
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override;
  void SendFrame(const FrameMessage& frame) override;
  void SendHistory(const HistoryMessage& history) override;
  void SendStatus(const StatusMessage& status) override { run_.observer_.OnStatus(status); }
  void Flush(double /*seconds*/) override {}

 private:
  PageRun& run_;
};

// The protocol of an agent process, whose thread is Work.
class PageRun::Agent final : public AgentEndpoint {
 public:
  Agent(PageRun& run, AgentOptions options)
      : run_(run),
        options_(std::move(options)),
        resources_{.scenes = options_.scenes},
        protocol_(*this, options_, resources_, Now()) {}

  void Start(AgentHandler& /*handler*/) override {}
  void SendJoin(const JoinMessage& join) override {
    run_.messages_.push_back([run = &run_, join](double now) { run->coordinator_->OnJoin(join, now); });
  }
  void SendProposal(const ProposalMessage& proposal) override {
    SendSharedProposal(std::make_shared<const ProposalMessage>(proposal));
  }
  void SendSharedProposal(const SharedProposal& proposal) override {
    run_.messages_.push_back(
        [run = &run_, proposal](double now) { run->coordinator_->OnProposal(*proposal, now, proposal); });
  }

  // What an agent's own thread does.
  void Work(double now) {
    while (std::optional<ReplicaTask> task = protocol_.BeginTask()) {
      task->Perform(options_, resources_);
      protocol_.FinishTask(*task);
    }
    if (const std::optional<JoinMessage> join = protocol_.Poll(now)) SendJoin(*join);
  }

  AgentProtocol& protocol() { return protocol_; }
  AgentId id() const { return options_.agent; }

 private:
  PageRun& run_;
  const AgentOptions options_;
  const AgentResources resources_;
  AgentProtocol protocol_;
};

void PageRun::Service::SendSession(const SessionMessage& session) {
  run_.session_ = std::make_shared<const SessionMessage>(session);
  run_.observer_.OnSession(session);
  run_.messages_.push_back([this, sent = run_.session_](double) {
    for (const auto& agent : run_.agents_) agent->protocol().OnSession(*sent);
  });
}

void PageRun::Service::SendAdmissions(const std::vector<AdmissionMessage>& admissions) {
  run_.messages_.push_back([this, admissions](double) {
    for (const auto& agent : run_.agents_) {
      for (const AdmissionMessage& admission : admissions) agent->protocol().OnAdmission(admission);
    }
  });
}

void PageRun::Service::SendFrame(const FrameMessage& frame) {
  const auto shared = std::make_shared<const FrameMessage>(frame);
  run_.observer_.OnFrame(shared);
  run_.messages_.push_back([this, shared](double now) {
    for (const auto& agent : run_.agents_) agent->protocol().OnFrame(*shared, now);
  });
}

void PageRun::Service::SendHistory(const HistoryMessage& history) {
  run_.messages_.push_back([this, history](double) {
    for (const auto& agent : run_.agents_) agent->protocol().OnHistory(history);
  });
}

Result<std::unique_ptr<PageRun>> PageRun::Start(const std::string& file, std::optional<std::uint64_t> seed,
                                                const std::shared_ptr<SceneCache>& scenes, ObserverHandler& observer) {
  LoadOverrides overrides;
  overrides.seed = seed;
  overrides.check_controller = CheckController;
  overrides.check_in_world = CheckControllerNeeds;
  Result<LoadedWorld> loaded = LoadWorld(file, overrides);
  if (!loaded.ok()) return loaded.error();
  return std::unique_ptr<PageRun>(new PageRun(std::move(loaded).value(), file, overrides, scenes, observer));
}

PageRun::PageRun(LoadedWorld loaded, const std::string& file, const LoadOverrides& overrides,
                 const std::shared_ptr<SceneCache>& scenes, ObserverHandler& observer)
    : observer_(observer), endpoint_(std::make_unique<Service>(*this)) {
  service_.settings = loaded.settings;
  service_.settings.is_watched = true;
  // A page has no network: what the scenario asks for is left out rather than refused.
  service_.settings.ros = false;
  service_.scenes = scenes;
  service_.world_file = file;
  service_.overrides = overrides;
  RestrictRequests({}, loaded.world, loaded.files, service_);

  CoordinatorOptions options;
  options.settings = service_.settings;
  options.run = MakeRandomId();
  options.lease_seconds = kNever;
  options.start_timeout_seconds = 0.0;
  options.phase_times = &phase_times_;
  options.scenes = scenes;
  options.host = "this page";
  const double now = Now();
  coordinator_ = std::make_unique<TickCoordinator>(std::make_shared<const Scene>(std::move(loaded.world)), options,
                                                   *endpoint_, RunObservers(), now);
  next_status_ = now + kStatusPeriod;
  if (!coordinator_->scene()->world().robots.empty()) AddAgent({});
  coordinator_->Announce();
}

PageRun::~PageRun() = default;

void PageRun::AddAgent(const std::vector<std::string>& robots) {
  AgentOptions options;
  options.agent = ++newest_agent_;
  options.robots = robots;
  options.session_timeout_seconds = 0.0;
  options.scenes = service_.scenes;
  agents_.push_back(std::make_unique<Agent>(*this, std::move(options)));
  if (session_ != nullptr) agents_.back()->protocol().OnSession(*session_);
}

// An agent that is over is told to the service as a process that ended.
void PageRun::WorkOfAgents(double now) {
  if (const std::vector<std::string> robots = coordinator_->DrainNewRobots(); !robots.empty()) AddAgent(robots);
  for (auto at = agents_.begin(); at != agents_.end();) {
    Agent& agent = **at;
    agent.Work(now);
    if (!agent.protocol().over()) {
      ++at;
      continue;
    }
    if (const Status failure = agent.protocol().failure(); !failure.ok()) coordinator_->Fail(failure.error(), now);
    const AgentId id = agent.id();
    at = agents_.erase(at);
    coordinator_->OnAgentGone(id, now);
  }
}

void PageRun::Report(double now) {
  (void)coordinator_->DrainEvents();  // the frames have them
  (void)coordinator_->DrainNotices();
  if (now < next_status_ || coordinator_->phase() == RunPhase::kOver) return;
  next_status_ = now + kStatusPeriod;
  endpoint_->SendStatus(coordinator_->MakeStatus(now));
}

// Infinity once the run is over: the page then only waits for requests.
double PageRun::NextDue() const {
  if (coordinator_->phase() == RunPhase::kOver) return std::numeric_limits<double>::infinity();
  double next = std::min(coordinator_->NextPoll(), next_status_);
  for (const auto& agent : agents_) {
    next = agent->protocol().has_task() ? 0.0 : std::min(next, agent->protocol().NextPoll());
  }
  return next;
}

// Messages first: they are what a network would have delivered meanwhile.
double PageRun::Work(double seconds) {
  const double end = Now() + seconds;
  for (;;) {
    const double now = Now();
    if (messages_.empty()) {
      coordinator_->AdvanceRewind(now);
      coordinator_->Poll(now);
      // Only when no message waits: an agent then answers the newest frame, as it would after a delay of the network.
      if (messages_.empty()) WorkOfAgents(now);
      Report(now);
    } else {
      const Message message = std::move(messages_.front());
      messages_.pop_front();
      message(now);
    }
    if (messages_.empty()) {
      const double next = NextDue();
      if (next > now) return std::min(next - now, kNever);
    }
    if (now >= end) return 0.0;
  }
}

// Spawns read a file of the page's memory, as the service does on a thread of its own.
void PageRun::Request(const control::Request& request, const ControlReplyTo& reply) {
  const bool lists = control::Is<control::Spawnables>(request);
  if (!lists && !control::Is<control::Spawn>(request)) return coordinator_->Control(request, reply, Now());
  const Result<RequestedFile> file = ReadRequestedFile(service_, request);
  if (!file.ok()) return coordinator_->Reply(reply, file.error());
  if (lists) return coordinator_->Reply(reply, file.value().listed);
  coordinator_->Control(request, reply, Now(), file.value().world);
}

}  // namespace troupe
