#include "ros/participant/participant_server.h"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "ros/link/link.h"

namespace troupe::ros {
namespace {

// The list of all nodes is one sample, so the nodes of agents that start together are announced together, and the more
// agents there are the more of them.
constexpr auto kAnnounceDelay = std::chrono::milliseconds(20);
constexpr auto kAnnounceDelayOfAgent = std::chrono::microseconds(200);
constexpr auto kCheckInterval = std::chrono::milliseconds(500);
// In which an agent that starts a program connects to it.
constexpr auto kFirstConnection = std::chrono::seconds(10);
// For which a domain without agents waits for the next one: longer than its endpoints.
constexpr auto kUnusedTime = std::chrono::seconds(3);
// For which the readers of all topics together may acknowledge the last samples. One that was killed does not, until
// its lease expires.
constexpr auto kLastAcknowledgments = std::chrono::seconds(1);
constexpr int kLastReads = 10;  // of an agent: more than a socket holds

[[noreturn]] void Throw(const std::string& doing) {
  throw std::runtime_error(doing + ": " + std::strerror(errno));
}

}  // namespace

ParticipantServer::ParticipantServer(const RosNetwork& network, int listening, Serving serving, const WakeEvent& stop,
                                     std::function<void(const std::string&)> report)
    : stop_(stop),
      report_(std::move(report)),
      network_(network),
      serving_(serving),
      listening_(listening),
      check_at_(Clock::now() + kCheckInterval) {
  if (UsesFastDds(network)) fast_dds_ = std::make_unique<FastDdsSide>(network, report_);
  domains_.try_emplace(network.domain, network, fast_dds_.get(), [this] { wake_.Signal(); });
  events_ = epoll_create1(EPOLL_CLOEXEC);
  if (events_ < 0 || listen(listening_, SOMAXCONN) != 0) Throw("waiting for agents");
  for (const int descriptor : {listening_, wake_.descriptor(), stop_.descriptor()}) {
    if (!Watch(EPOLL_CTL_ADD, descriptor, EPOLLIN)) Throw("waiting for agents");
  }
}

ParticipantServer::~ParticipantServer() {
  agents_.clear();
  const Clock::time_point end = Clock::now() + kLastAcknowledgments;
  for (const auto& [number, domain] : domains_) {
    domain.participant.AwaitAcknowledgments(std::chrono::duration<double>(end - Clock::now()).count());
  }
  domains_.clear();  // its services end on the other side, too
  for (const int descriptor : {listening_, events_}) {
    if (descriptor >= 0) close(descriptor);
  }
}

void ParticipantServer::Run() {
  std::array<epoll_event, 64> ready{};
  for (;;) {
    const int count = epoll_wait(events_, ready.data(), static_cast<int>(ready.size()), WaitMilliseconds());
    if (count < 0 && errno != EINTR) Throw("waiting for agents");
    for (int i = 0; i < count; ++i) {
      const int descriptor = ready[static_cast<std::size_t>(i)].data.fd;
      if (descriptor == stop_.descriptor()) return PassLastSamples();
      if (descriptor == listening_) {
        AcceptAgents();
      } else if (descriptor == wake_.descriptor()) {
        wake_.Clear();
        // The agent is not known: all that have something to send.
        for (const auto& [connection, agent] : agents_) WatchOutput(connection, *agent);
        for (auto& [number, domain] : domains_) {
          if (domain.watch) domain.watch->Update();
          UpdateGate(domain);
          ServeCycloneIfFound(domain);
        }
      } else {
        Process(descriptor);
      }
    }
    AnnounceIfDue();
    CheckIfDue();
    ProcessFastDds();
    for (auto& [number, domain] : domains_) {
      if (domain.gate && domain.gate->due() && *domain.gate->due() <= Clock::now()) UpdateGate(domain);
    }
    if (serving_ == Serving::kWhileUsed && IsUnused()) return;
  }
}

void ParticipantServer::ServeCycloneIfFound(HostDomain& domain) {
  try {
    domain.ServeCycloneIfFound();
  } catch (const dds::Exception& exception) {
    report_(std::string("serving clients on Cyclone DDS: ") + exception.what());
  }
}

void ParticipantServer::UpdateGate(HostDomain& domain) {
  if (!domain.gate) return;
  try {
    domain.gate->Update();
  } catch (const dds::Exception& exception) {
    report_(std::string("showing a tick to nodes: ") + exception.what());
  }
}

bool ParticipantServer::IsUnused() const {
  return agents_.empty() && (had_agents_ || Clock::now() - started_ > kFirstConnection);
}

void ParticipantServer::ProcessFastDds() {
  if (!fast_dds_) return;
  if (fast_dds_->Process()) {
    for (auto& [number, domain] : domains_) {
      domain.announce_at = std::min(domain.announce_at, Clock::now() + kAnnounceDelay);
    }
  }
  const int descriptor = fast_dds_->descriptor();  // that of an ended process is closed, and watched no more
  if (descriptor < 0) {
    watched_side_ = -1;
    return;
  }
  Watch(watched_side_ == descriptor ? EPOLL_CTL_MOD : EPOLL_CTL_ADD, descriptor,
        fast_dds_->has_output() ? EPOLLIN | EPOLLOUT : EPOLLIN);
  watched_side_ = descriptor;
}

HostDomain& ParticipantServer::Join(std::uint32_t number) {
  RosNetwork network = network_;
  network.domain = number;
  HostDomain& domain = domains_.try_emplace(number, network, fast_dds_.get(), [this] { wake_.Signal(); }).first->second;
  domain.unused_until.reset();
  return domain;
}

void ParticipantServer::AcceptAgents() {
  for (;;) {
    const int connection = Accept(listening_);
    if (connection < 0) {
      if (errno == EMFILE || errno == ENFILE) AwaitDescriptors();
      return;
    }
    lacks_descriptors_ = false;
    had_agents_ = true;
    agents_[connection] = std::make_unique<AgentEndpoints>(
        [this](std::uint32_t domain) -> HostDomain& { return Join(domain); }, connection, [this] { wake_.Signal(); });
    if (!Watch(EPOLL_CTL_ADD, connection, EPOLLIN)) Throw("waiting for an agent");
  }
}

// The agent that connects stays ready: without this the loop would not sleep.
void ParticipantServer::AwaitDescriptors() {
  Watch(EPOLL_CTL_MOD, listening_, 0);
  if (std::exchange(lacks_descriptors_, true)) return;
  report_("an agent waits for its connection: this process may open no more files (ulimit -n)");
}

void ParticipantServer::Process(int connection) {
  const auto found = agents_.find(connection);
  if (found == agents_.end()) return;
  AgentEndpoints& agent = *found->second;
  const bool open = agent.Process();
  HostDomain* const domain = agent.domain();
  bool changed = agent.ConsumeAnnouncement();
  if (open) {
    WatchOutput(connection, agent);
  } else {
    if (!agent.problem().empty()) report_("a connection was closed: " + agent.problem());
    changed = changed || agent.has_nodes();
    agents_.erase(found);
    writing_.erase(connection);
    // Kept for a while: an agent that is restarted finds its endpoints, which tools then need not discover again.
    if (domain != nullptr && domain->agents.empty()) domain->unused_until = Clock::now() + kUnusedTime;
  }
  if (!changed || domain == nullptr) return;
  const auto delay = kAnnounceDelay + static_cast<int>(domain->agents.size()) * kAnnounceDelayOfAgent;
  domain->announce_at = std::min(domain->announce_at, Clock::now() + delay);
}

bool ParticipantServer::Watch(int operation, int descriptor, std::uint32_t events) const {
  epoll_event event{};
  event.events = events;
  event.data.fd = descriptor;
  return epoll_ctl(events_, operation, descriptor, &event) == 0;
}

// A watch that does not change costs no system call.
void ParticipantServer::WatchOutput(int connection, const AgentEndpoints& agent) {
  const bool has_output = agent.has_output();
  if (has_output == writing_.contains(connection)) return;
  Watch(EPOLL_CTL_MOD, connection, has_output ? EPOLLIN | EPOLLOUT : EPOLLIN);
  if (has_output) {
    writing_.insert(connection);
  } else {
    writing_.erase(connection);
  }
}

void ParticipantServer::AnnounceIfDue() {
  for (auto& [number, domain] : domains_) {
    if (Clock::now() < domain.announce_at) continue;
    try {
      domain.participant.Announce();
      domain.announce_at = Clock::time_point::max();
    } catch (const dds::Exception&) {  // a tool that does not read has filled the cache
      domain.announce_at = Clock::now() + kAnnounceDelay;
    }
    domain.has_new_readers = true;
  }
}

// The agents have written them, and ended.
void ParticipantServer::PassLastSamples() {
  for (const auto& [connection, agent] : agents_) {
    for (int i = 0; i < kLastReads && agent->Process(); ++i) {
    }
  }
}

void ParticipantServer::CheckIfDue() {
  if (Clock::now() < check_at_) return;
  check_at_ = Clock::now() + kCheckInterval;
  if (lacks_descriptors_) Watch(EPOLL_CTL_MOD, listening_, EPOLLIN);
  for (auto& [number, domain] : domains_) {
    // Writers of other programs may have been discovered before the reader that they do not fit.
    if (std::exchange(domain.has_new_readers, false)) domain.participant.WatchKnownWriters();
    PassMismatches(domain);
    domain.pools.EndThoseUntil(Clock::now());
  }
  std::erase_if(domains_, [this](const auto& entry) {
    return entry.first != network_.domain && entry.second.unused_until && *entry.second.unused_until <= Clock::now();
  });
}

// To the agent that reads the topic; of another distribution, to the one that asked.
void ParticipantServer::PassMismatches(HostDomain& domain) {
  for (const Mismatch& mismatch : domain.participant.DrainMismatchesOfTopics()) {
    for (const auto& [connection, agent] : agents_) {
      if (agent->domain() != &domain) continue;
      const bool is_of_topic = mismatch.topic.empty() ? agent->watches_distributions() : agent->Reads(mismatch.topic);
      if (!is_of_topic) continue;
      agent->Report(mismatch.report);
      break;
    }
  }
}

int ParticipantServer::WaitMilliseconds() const {
  Clock::time_point next = check_at_;
  if (fast_dds_ && fast_dds_->due()) next = std::min(next, *fast_dds_->due());
  for (const auto& [number, domain] : domains_) {
    next = std::min(next, domain.announce_at);
    if (domain.gate && domain.gate->due()) next = std::min(next, *domain.gate->due());
  }
  const auto left = next - Clock::now();
  // Rounded up: a wait that ends a part of a millisecond early would turn in a loop.
  return std::max(0, static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(left).count()) + 1);
}

}  // namespace troupe::ros
