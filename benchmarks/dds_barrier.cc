// What lockstep over DDS costs by itself: a service and N agent processes that only answer. Prints a JSON object:
// microseconds for each robot and tick, the time until all had met, and an agent's memory.
//   dds_barrier [agents=100] [ticks=1000]
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "benchmarks/barrier_processes.h"
#include "common/dds/dds_transport.h"

namespace troupe::bench {
namespace {

constexpr double kTimeToMeet = 60.0;    // s
constexpr double kTimeToRepeat = 0.05;  // s, of a frame that is not answered
constexpr int kMostRepeats = 200;       // of one frame: something is broken

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

void RunAgent(const DdsOptions& dds, AgentId id) {
  auto transport = MakeDdsAgentTransport(dds);
  auto endpoint = transport->MakeAgentEndpoint(id);
  Agent agent(*endpoint, id);
  endpoint->Start(agent);
  while (!agent.over()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

// As if all robots had driven on.
void Drive(WorldState& state) {
  for (RobotState& robot : state.robots) {
    robot.X_WR.x += 1e-3;
    robot.X_WR.y += 2e-3;
    robot.X_WR.heading += 1e-4;
    robot.twist.vx += 1e-5;
    robot.twist.wz += 1e-5;
  }
}

// Until all agents have left; kills those that do not.
void End(Service& service, ServiceEndpoint& endpoint, FrameMessage frame, const std::vector<pid_t>& agents) {
  frame.last = true;
  endpoint.SendFrame(frame);
  endpoint.Flush(1.0);
  if (!service.AwaitJoined(0, 10.0)) {
    for (const pid_t pid : agents) kill(pid, SIGKILL);
  }
  WaitForAll(agents);
}

int Run(const BarrierOptions& options, const DdsOptions& dds) {
  const auto start = Clock::now();
  std::vector<pid_t> children;
  for (int i = 1; i <= options.agents; ++i) {
    children.push_back(Fork([&dds, i] { RunAgent(dds, static_cast<AgentId>(i)); }));
  }
  auto transport = MakeDdsServiceTransport(dds, nullptr);
  auto endpoint = transport->MakeServiceEndpoint();
  Service service;
  SessionMessage session;
  session.run = 1;
  session.lease_seconds = dds.lease_seconds;
  endpoint->SendSession(session);
  endpoint->Start(service);
  FrameMessage frame;
  frame.run = 1;
  frame.state.robots.resize(static_cast<std::size_t>(options.agents));
  if (!service.AwaitJoined(static_cast<std::size_t>(options.agents), kTimeToMeet)) {
    End(service, *endpoint, frame, children);
    return std::fprintf(stderr, "not all agents joined\n"), 3;
  }
  const double met = Since(start);

  int repeated = 0;
  bool stuck = false;
  const double used_before = ProcessorTime(children);
  const auto begin = Clock::now();
  for (std::uint64_t tick = 0; tick < options.ticks && !stuck; ++tick) {
    frame.state.tick = tick;
    Drive(frame.state);
    service.Open(tick + 1, options.agents);
    endpoint->SendFrame(frame);
    for (int repeats = 0; !stuck && !service.Await(kTimeToRepeat); ++repeats, ++repeated) {
      endpoint->SendFrame(frame);
      stuck = repeats >= kMostRepeats;
    }
  }
  const double share = 1e6 / static_cast<double>(options.ticks) / options.agents;
  const double wall = Since(begin) * share;
  const double processor = (ProcessorTime(children) - used_before) * share;
  const double agent_mib = static_cast<double>(StatusNumber(children.back(), "VmHWM")) / 1024.0;
  const long threads = StatusNumber(children.back(), "Threads");
  frame.state.tick = options.ticks;
  End(service, *endpoint, frame, children);
  if (stuck) return std::fprintf(stderr, "a frame was not answered\n"), 3;
  std::printf(
      "{\"processes\": %d, \"ticks\": %lu, \"wall_us\": %.3f, \"processor_us\": %.3f, \"met_seconds\": %.3f, "
      "\"frames_repeated\": %d, \"agent_mib\": %.2f, \"agent_threads\": %ld}\n",
      options.agents, options.ticks, wall, processor, met, repeated, agent_mib, threads);
  return 0;
}

}  // namespace
}  // namespace troupe::bench

int main(int argc, char** argv) {
  const troupe::bench::BarrierOptions options = troupe::bench::ParseBarrierOptions(argc, argv);
  troupe::DdsOptions dds;
  dds.domain = 77;
  dds.session = "bench-" + std::to_string(getpid());
  dds.on_problem = [](const std::string& problem) { std::fprintf(stderr, "%s\n", problem.c_str()); };
  return troupe::bench::Run(options, dds);
}
