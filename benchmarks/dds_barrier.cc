// The cost of lockstep over DDS alone: a service, agent processes that only answer, and observer processes that read
// all frames. Prints a JSON object: microseconds for each robot and tick, the time until all agents had joined, an
// agent's memory, and the share of the frames that the observers saw.
//   dds_barrier [agents=100] [ticks=1000] [observers=0] [data sharing: on (default) or off]
#include <sys/mman.h>

#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <thread>

#include "benchmarks/barrier_processes.h"
#include "transport/dds/transport/dds_transport.h"

namespace troupe::bench {
namespace {

constexpr double kDiscoveryTimeout = 60.0;  // s
constexpr double kResendPeriod = 0.05;      // s, of an unanswered frame
constexpr int kMaxResends = 200;            // of one frame: beyond it the benchmark fails

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

// The counts of all observers, in memory that their processes share with this one.
struct ObserverCounts {
  std::atomic<int> joined = 0;
  std::atomic<std::uint64_t> frames = 0;
};

ObserverCounts& MakeSharedCounts() {
  void* const memory = mmap(nullptr, sizeof(ObserverCounts), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    std::perror("mmap");
    std::exit(3);
  }
  return *new (memory) ObserverCounts;
}

class Observer : public ObserverHandler {
 public:
  explicit Observer(ObserverCounts& counts) : counts_(counts) {}
  void OnSession(const SessionMessage&) override {}
  void OnFrame(const SharedFrame& frame) override {
    if (!joined_) ++counts_.joined;
    joined_ = true;
    if (frame->state.tick > 0) ++counts_.frames;
  }
  void OnStatus(const StatusMessage&) override {}
  void OnServiceGone() override { over_ = true; }
  bool over() const { return over_; }

 private:
  ObserverCounts& counts_;
  bool joined_ = false;
  std::atomic<bool> over_ = false;
};

void RunObserver(const DdsOptions& dds, ObserverCounts& counts) {
  auto transport = MakeDdsObserverTransport(dds);
  auto endpoint = transport->MakeObserverEndpoint();
  Observer observer(counts);
  endpoint->Start(observer);
  while (!observer.over()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

void RunAgent(const DdsOptions& dds, AgentId id) {
  auto transport = MakeDdsAgentTransport(dds);
  auto endpoint = transport->MakeAgentEndpoint(id);
  Agent agent(*endpoint, id);
  endpoint->Start(agent);
  while (!agent.over()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

// As if all robots had driven.
void Drive(WorldState& state) {
  for (RobotState& robot : state.robots) {
    robot.X_WR.x += 1e-3;
    robot.X_WR.y += 2e-3;
    robot.X_WR.heading += 1e-4;
    robot.twist.vx += 1e-5;
    robot.twist.wz += 1e-5;
  }
}

// Returns when all other processes have ended; kills them when the agents do not leave.
void End(Service& service, std::unique_ptr<ServiceEndpoint>& endpoint, FrameMessage frame,
         const std::vector<pid_t>& processes) {
  frame.last = true;
  endpoint->SendFrame(frame);
  endpoint->Flush(1.0);
  if (!service.AwaitJoined(0, 10.0)) {
    for (const pid_t pid : processes) kill(pid, SIGKILL);
  }
  endpoint.reset();  // observers end when the service has ended
  WaitForAll(processes);
}

// The ticks of a run; the number of resent frames, or nothing when one was never answered.
std::optional<int> RunTicks(const BarrierOptions& options, Service& service, ServiceEndpoint& endpoint,
                            FrameMessage& frame) {
  int repeated = 0;
  for (std::uint64_t tick = 0; tick < options.ticks; ++tick) {
    frame.state.tick = tick;
    Drive(frame.state);
    service.Open(tick + 1, options.agents);
    endpoint.SendFrame(frame);
    for (int repeats = 0; !service.Await(kResendPeriod); ++repeats, ++repeated) {
      if (repeats >= kMaxResends) return std::nullopt;
      endpoint.SendFrame(frame);
    }
  }
  return repeated;
}

bool AwaitObservers(const ObserverCounts& counts, int count) {
  const auto start = Clock::now();
  while (counts.joined < count && Since(start) < kDiscoveryTimeout)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return counts.joined >= count;
}

int Run(const BarrierOptions& options, const DdsOptions& dds) {
  const auto start = Clock::now();
  ObserverCounts& counts = MakeSharedCounts();
  std::vector<pid_t> children;
  for (int i = 0; i < options.observers; ++i) {
    children.push_back(Fork([&] { RunObserver(dds, counts); }));
  }
  for (int i = 1; i <= options.agents; ++i) {
    children.push_back(Fork([&dds, i] { RunAgent(dds, static_cast<AgentId>(i)); }));
  }
  const auto transport = MakeDdsServiceTransport(dds).transport;
  auto endpoint = transport->MakeServiceEndpoint();
  Service service;
  SessionMessage session;
  session.run = 1;
  session.lease_seconds = dds.lease();
  endpoint->SendSession(session);
  endpoint->Start(service);
  FrameMessage frame;
  frame.run = 1;
  frame.state.robots.resize(static_cast<std::size_t>(options.agents));
  if (!service.AwaitJoined(static_cast<std::size_t>(options.agents), kDiscoveryTimeout)) {
    End(service, endpoint, frame, children);
    return std::fprintf(stderr, "not all agents joined\n"), 3;
  }
  const double met = Since(start);
  endpoint->SendFrame(frame);
  const bool observed = AwaitObservers(counts, options.observers);

  const double used_before = ProcessorTime(children);
  const auto begin = Clock::now();
  const std::optional<int> repeated = RunTicks(options, service, *endpoint, frame);
  const double seconds = Since(begin);
  const double share = 1e6 / static_cast<double>(options.ticks) / options.agents;
  const double processor = (ProcessorTime(children) - used_before) * share;
  const double agent_mib = static_cast<double>(StatusNumber(children.back(), "VmHWM")) / 1024.0;
  const long threads = StatusNumber(children.back(), "Threads");
  const double frames_to_see = static_cast<double>(options.ticks - 1) * options.observers;
  const double seen = frames_to_see > 0.0 ? static_cast<double>(counts.frames) / frames_to_see : 1.0;
  frame.state.tick = options.ticks;
  End(service, endpoint, frame, children);
  if (!repeated) return std::fprintf(stderr, "a frame was not answered\n"), 3;
  if (!observed) return std::fprintf(stderr, "not all observers saw a frame\n"), 3;
  std::printf(
      "{\"processes\": %d, \"observers\": %d, \"ticks\": %lu, \"ticks_per_second\": %.1f, \"wall_us\": %.3f, "
      "\"processor_us\": %.3f, \"met_seconds\": %.3f, \"frames_repeated\": %d, \"frames_observed\": %.3f, "
      "\"agent_mib\": %.2f, \"agent_threads\": %ld}\n",
      options.agents, options.observers, options.ticks, static_cast<double>(options.ticks) / seconds, seconds * share,
      processor, met, *repeated, seen, agent_mib, threads);
  return 0;
}

}  // namespace
}  // namespace troupe::bench

int main(int argc, char** argv) {
  const troupe::bench::BarrierOptions options = troupe::bench::ParseBarrierOptions(argc, argv);
  troupe::DdsOptions dds;
  dds.data_sharing = options.data_sharing;
  dds.domain = 77;
  dds.session = "bench-" + std::to_string(getpid());
  dds.on_problem = [](const std::string& problem) { std::fprintf(stderr, "%s\n", problem.c_str()); };
  return troupe::bench::Run(options, dds);
}
