#include "ros/participant/participant_server.h"

#include <sys/epoll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "ros/link/socket_name.h"

namespace troupe::ros {
namespace {

// The list of all nodes is one sample, so those of agents that start together are announced together, and the more
// agents there are the more of them.
constexpr auto kAnnounceDelay = std::chrono::milliseconds(20);
constexpr auto kAnnounceDelayOfAgent = std::chrono::microseconds(200);
constexpr auto kCheckInterval = std::chrono::milliseconds(500);
constexpr int kLastReads = 10;  // of an agent: more than a socket holds

[[noreturn]] void Throw(const std::string& doing) {
  throw std::runtime_error(doing + ": " + std::strerror(errno));
}

}  // namespace

ParticipantServer::ParticipantServer(const RosOptions& options, int listening, const WakeEvent& stop,
                                     std::function<void(const std::string&)> report)
    : stop_(stop),
      report_(std::move(report)),
      listening_(listening),
      participant_(options),
      check_at_(Clock::now() + kCheckInterval) {
  participant_.WatchWriters();
  events_ = epoll_create1(EPOLL_CLOEXEC);
  if (events_ < 0) Throw("waiting for agents");
  for (const int descriptor : {listening_, wake_.descriptor(), stop_.descriptor()}) {
    if (!Watch(EPOLL_CTL_ADD, descriptor, EPOLLIN)) Throw("waiting for agents");
  }
}

ParticipantServer::~ParticipantServer() {
  agents_.clear();
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
      } else {
        Process(descriptor);
      }
    }
    AnnounceIfDue();
    CheckIfDue();
  }
}

void ParticipantServer::AcceptAgents() {
  for (;;) {
    const int connection = Accept(listening_);
    if (connection < 0) {
      if (errno == EMFILE || errno == ENFILE) AwaitDescriptors();
      return;
    }
    lacks_descriptors_ = false;
    agents_[connection] =
        std::make_unique<AgentEndpoints>(participant_, pools_, connection, [this] { wake_.Signal(); });
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
  const bool goes_on = agent.Process();
  bool changed = agent.TakeAnnouncement();
  if (goes_on) {
    WatchOutput(connection, agent);
  } else {
    if (!agent.problem().empty()) report_("a connection was closed: " + agent.problem());
    changed = changed || agent.has_nodes();
    agents_.erase(found);
  }
  if (!changed) return;
  const auto delay = kAnnounceDelay + static_cast<int>(agents_.size()) * kAnnounceDelayOfAgent;
  announce_at_ = std::min(announce_at_, Clock::now() + delay);
}

bool ParticipantServer::Watch(int operation, int descriptor, std::uint32_t events) const {
  epoll_event event{};
  event.events = events;
  event.data.fd = descriptor;
  return epoll_ctl(events_, operation, descriptor, &event) == 0;
}

void ParticipantServer::WatchOutput(int connection, const AgentEndpoints& agent) const {
  Watch(EPOLL_CTL_MOD, connection, agent.has_output() ? EPOLLIN | EPOLLOUT : EPOLLIN);
}

void ParticipantServer::AnnounceIfDue() {
  if (Clock::now() < announce_at_) return;
  try {
    participant_.Announce();
    announce_at_ = Clock::time_point::max();
  } catch (const dds::Exception&) {  // a tool that does not read has filled the cache
    announce_at_ = Clock::now() + kAnnounceDelay;
  }
  has_new_readers_ = true;
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
  if (std::exchange(has_new_readers_, false)) participant_.WatchKnownWriters();
  if (lacks_descriptors_) Watch(EPOLL_CTL_MOD, listening_, EPOLLIN);
  PassMismatches();
  pools_.EndThoseUntil(Clock::now());
}

// To the agent that reads the topic; of another distribution, to the one that asked.
void ParticipantServer::PassMismatches() {
  for (const Mismatch& mismatch : participant_.DrainMismatchesOfTopics()) {
    for (const auto& [connection, agent] : agents_) {
      const bool is_of_topic = mismatch.topic.empty() ? agent->watches_distributions() : agent->Reads(mismatch.topic);
      if (!is_of_topic) continue;
      agent->Report(mismatch.report);
      break;
    }
  }
}

int ParticipantServer::WaitMilliseconds() const {
  const auto left = std::min(announce_at_, check_at_) - Clock::now();
  return std::max(0, static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(left).count()) + 1);
}

}  // namespace troupe::ros
