// What lockstep costs: a service and N agent processes that only answer, over DDS and, beside it, over a plain UDP
// barrier (send to each, receive from each). Prints microseconds per robot and tick, the time until all had met, and an
// agent's memory.
//   bench_tick_latency [agents=100] [ticks=1000] [domain=77]
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/dds_transport.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr std::size_t kAnswersAtATime = 100;

struct Options {
  int agents = 100;
  std::uint64_t ticks = 1000;
  DdsOptions dds;
};

// Answers every frame until the last.
class Agent : public AgentHandler {
 public:
  Agent(AgentEndpoint& endpoint, AgentId id) : endpoint_(endpoint), id_(id) {}
  void OnSession(const SessionMessage& session) override {
    JoinMessage join;
    join.run = session.run;
    join.agent = id_;
    join.robots = {"r" + std::to_string(id_)};
    endpoint_.SendJoin(join);
  }
  void OnAdmission(const AdmissionMessage&) override {}
  void OnFrame(const FrameMessage& frame) override {
    if (frame.last) {
      over_ = true;
      return;
    }
    ProposalMessage proposal;
    proposal.run = frame.run;
    proposal.agent = id_;
    proposal.tick = frame.state.tick + 1;
    proposal.proposals = {{RobotId(id_ - 1), {0.5, 0.0, 0.1}}};
    endpoint_.SendProposal(proposal);
  }
  void OnServiceGone() override { over_ = true; }
  bool over() const { return over_; }

 private:
  AgentEndpoint& endpoint_;
  AgentId id_;
  std::atomic<bool> over_ = false;
};

class Service : public ServiceHandler {
 public:
  void OnJoin(const JoinMessage& join) override {
    const std::lock_guard lock(mutex_);
    joined_[join.agent] = join.pid;
    changed_.notify_one();
  }
  void OnProposal(const ProposalMessage& proposal) override {
    const std::lock_guard lock(mutex_);
    std::uint64_t& tick = answered_[proposal.agent];
    if (proposal.tick != open_ || tick == open_) return;
    tick = open_;
    if (--missing_ == 0) changed_.notify_one();
  }
  void OnAgentGone(AgentId agent) override {
    const std::lock_guard lock(mutex_);
    joined_.erase(agent);
    changed_.notify_one();
  }
  void OnRivalService(const SessionMessage&) override {}

  bool AwaitJoined(std::size_t count, double seconds) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return joined_.size() == count; });
  }
  void Open(std::uint64_t tick, int agents) {
    const std::lock_guard lock(mutex_);
    open_ = tick;
    missing_ = agents;
  }
  bool Await(double seconds) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return missing_ == 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<AgentId, std::uint32_t> joined_;
  std::map<AgentId, std::uint64_t> answered_;
  std::uint64_t open_ = 0;
  int missing_ = 0;
};

// The child's function, then its end. Children die with this program.
template <typename Function>
pid_t Fork(Function function) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  function();
  _exit(0);
}

void WaitForAll(const std::vector<pid_t>& children) {
  for (const pid_t pid : children) waitpid(pid, nullptr, 0);
}

std::string StatusLine(pid_t pid, const std::string& key) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key, 0) == 0) return line.substr(key.size() + 1);
  }
  return "?";
}

// Processor time of all threads of this process and its children, s. Unlike wall time it says something on a busy
// machine.
double ProcessorTime(std::vector<pid_t> processes) {
  processes.push_back(getpid());
  double nanoseconds = 0.0;
  for (const pid_t pid : processes) {
    const std::filesystem::path tasks = "/proc/" + std::to_string(pid) + "/task";
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
      std::ifstream file(task.path() / "schedstat");
      double running = 0.0;
      file >> running;
      nanoseconds += running;
    }
  }
  return nanoseconds * 1e-9;
}

void RunAgent(const Options& options, AgentId id) {
  auto transport = MakeDdsAgentTransport(options.dds);
  auto endpoint = transport->MakeAgentEndpoint(id);
  Agent agent(*endpoint, id);
  endpoint->Start(agent);
  while (!agent.over()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

FrameMessage MakeFrame(int robots) {
  FrameMessage frame;
  frame.run = 1;
  frame.state.robots.resize(static_cast<std::size_t>(robots));
  return frame;
}

void BenchDds(Options options) {
  const auto start = Clock::now();
  std::vector<pid_t> children;
  for (int i = 1; i <= options.agents; ++i) {
    children.push_back(Fork([&options, i] { RunAgent(options, static_cast<AgentId>(i)); }));
  }
  auto transport = MakeDdsServiceTransport(options.dds, nullptr);
  auto endpoint = transport->MakeServiceEndpoint();
  Service service;
  SessionMessage session;
  session.run = 1;
  session.lease_seconds = options.dds.lease_seconds;
  endpoint->SendSession(session);
  endpoint->Start(service);
  const bool joined = service.AwaitJoined(static_cast<std::size_t>(options.agents), 60.0);
  const double met = Since(start);
  if (!joined) std::printf("not all agents joined\n");

  FrameMessage frame = MakeFrame(options.agents);
  std::uint64_t repeated = 0;
  const double used_before = ProcessorTime(children);
  const auto begin = Clock::now();
  for (std::uint64_t tick = 0; tick < options.ticks && joined; ++tick) {
    frame.state.tick = tick;
    service.Open(tick + 1, options.agents);
    endpoint->SendFrame(frame);
    while (!service.Await(0.05)) {
      ++repeated;
      endpoint->SendFrame(frame);
    }
  }
  const double seconds = Since(begin);
  const double used = ProcessorTime(children) - used_before;
  const double share = 1e6 / static_cast<double>(options.ticks) / options.agents;
  std::printf("dds: %d agents: %.1f us per robot and tick (processor time %.1f), %.0f ticks/s\n", options.agents,
              seconds * share, used * share, static_cast<double>(options.ticks) / seconds);
  std::printf("     met after %.2f s, %lu frames repeated\n", met, repeated);
  std::printf("     agent: VmHWM%s, threads%s; service: VmHWM%s\n", StatusLine(children.back(), "VmHWM:").c_str(),
              StatusLine(children.back(), "Threads:").c_str(), StatusLine(getpid(), "VmHWM:").c_str());

  const auto ending = Clock::now();
  frame.state.tick = options.ticks;
  frame.last = true;
  endpoint->SendFrame(frame);
  endpoint->Flush(1.0);
  std::printf("     flushed after %.3f s,", Since(ending));
  const bool left = service.AwaitJoined(0, 10.0);
  std::printf(" %s after %.3f s\n", left ? "all left" : "not all left", Since(ending));
  for (const pid_t pid : children) {
    if (!left) kill(pid, SIGKILL);
  }
  WaitForAll(children);
}

// As many processes, one datagram of a frame's size to each and a small one back.
void BenchUdp(const Options& options) {
  const std::size_t frame_size = 64 + static_cast<std::size_t>(options.agents) * 57;
  std::vector<char> buffer(65536);
  const int service = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  if (bind(service, reinterpret_cast<sockaddr*>(&address), length) != 0) return std::perror("bind");
  getsockname(service, reinterpret_cast<sockaddr*>(&address), &length);
  std::vector<pid_t> children;
  std::vector<sockaddr_in> agents(static_cast<std::size_t>(options.agents));
  for (sockaddr_in& agent_address : agents) {
    children.push_back(Fork([&] {
      const int agent = socket(AF_INET, SOCK_DGRAM, 0);
      if (connect(agent, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) return;
      if (send(agent, "hello", 5, 0) != 5) return;
      while (recv(agent, buffer.data(), buffer.size(), 0) > 1) {
        if (send(agent, buffer.data(), 100, 0) != 100) return;
      }
    }));
    length = sizeof(agent_address);
    recvfrom(service, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&agent_address), &length);
  }
  const double used_before = ProcessorTime(children);
  const auto begin = Clock::now();
  for (std::uint64_t tick = 0; tick < options.ticks; ++tick) {
    // No more at a time than the socket's buffer holds answers of: there is no repair here.
    for (std::size_t first = 0; first < agents.size(); first += kAnswersAtATime) {
      const std::size_t end = std::min(agents.size(), first + kAnswersAtATime);
      for (std::size_t i = first; i < end; ++i) {
        sendto(service, buffer.data(), frame_size, 0, reinterpret_cast<const sockaddr*>(&agents[i]), sizeof(agents[i]));
      }
      for (std::size_t i = first; i < end; ++i) recv(service, buffer.data(), buffer.size(), 0);
    }
  }
  const double seconds = Since(begin);
  const double used = ProcessorTime(children) - used_before;
  const double share = 1e6 / static_cast<double>(options.ticks) / options.agents;
  std::printf("udp: %d agents: %.1f us per robot and tick (processor time %.1f)\n", options.agents, seconds * share,
              used * share);
  for (const sockaddr_in& agent : agents) {
    sendto(service, buffer.data(), 1, 0, reinterpret_cast<const sockaddr*>(&agent), sizeof(agent));
  }
  WaitForAll(children);
  close(service);
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  troupe::Options options;
  if (argc > 1) options.agents = std::atoi(argv[1]);
  if (argc > 2) options.ticks = static_cast<std::uint64_t>(std::atoll(argv[2]));
  options.dds.domain = argc > 3 ? static_cast<std::uint32_t>(std::atoi(argv[3])) : 77;
  options.dds.session = "bench-" + std::to_string(getpid());
  options.dds.on_problem = [](const std::string& problem) { std::fprintf(stderr, "%s\n", problem.c_str()); };
  if (options.agents < 1 || options.agents > 1000) {
    std::fprintf(stderr, "expected 1 to 1000 agents\n");
    return 2;
  }
  troupe::BenchUdp(options);
  std::fflush(stdout);
  troupe::BenchDds(options);
}
