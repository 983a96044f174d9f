#include "launcher/in_process_run.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

#include "common/protocol/faulty_transport.h"
#include "common/protocol/memory_transport.h"
#include "common/spatial/scene.h"
#include "common/trace/trace_file.h"
#include "launcher/merge_scans.h"
#include "launcher/output_parts.h"
#include "launcher/progress.h"
#include "launcher/signal_watch.h"
#include "robot-agent/agent/agent_host.h"
#include "robot-agent/ros/ros_gateway.h"
#include "world-service/ros/ros_world_gateway.h"
#include "world-service/service/run_service.h"

namespace troupe {
namespace {

// Agents for the robots that edits of the world bring.
class NewAgents {
 public:
  NewAgents(Transport& transport, AgentOptions options)
      : transport_(transport), options_(std::move(options)), scan_parts_(options_.scan_log, "--scans") {
    options_.trace = {};  // the first agent's
  }
  ~NewAgents() { Join(); }

  void Start(const std::vector<std::string>& robots) {
    AgentOptions options = options_;
    options.agent = ++options_.agent;
    options.robots = robots;
    if (!options.scan_log.empty()) {
      const Result<std::string> file = scan_parts_.Add();
      if (!file.ok()) return Tell(file.error().ToString());
      options.scan_log = file.value();
      scan_files_.push_back(file.value());
    }
    threads_.emplace_back([this, options] {
      const Result<bool> end = RunAgent(transport_.MakeAgentEndpoint(options.agent), options, stop_);
      if (!end.ok()) Tell("agent of " + options.robots.front() + ": " + end.error().ToString());
    });
  }

  // Ends those that have not come to the run's end.
  void Join() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  // Brings their scans into the file of the others. REQUIRES: Join was called.
  Status MergeScans() {
    if (scan_files_.empty()) return std::nullopt;
    const Result<std::string> all = scan_parts_.Add();
    if (!all.ok()) return all.error();
    scan_files_.insert(scan_files_.begin(), options_.scan_log);
    if (Status failure = troupe::MergeScans(scan_files_, all.value())) return failure;
    std::error_code failure;
    const auto overwrite = std::filesystem::copy_options::overwrite_existing;
    std::filesystem::copy_file(all.value(), options_.scan_log, overwrite, failure);
    if (failure) return Error{{options_.scan_log}, "cannot write scans: " + failure.message()};
    return std::nullopt;
  }

 private:
  static void Tell(const std::string& text) { fmt::print(stderr, "{}\n", text); }

  Transport& transport_;
  AgentOptions options_;  // of the last one
  OutputParts scan_parts_;
  std::vector<std::string> scan_files_;
  std::atomic<bool> stop_ = false;
  std::vector<std::thread> threads_;
};

class ProgressObserver : public RunObserver {
 public:
  ProgressObserver(std::size_t robots, NewAgents& new_agents) : robots_(robots), new_agents_(new_agents) {}

  void OnNewRobots(const std::vector<std::string>& robots) override { new_agents_.Start(robots); }

  void OnStarted(double startup_seconds) override {
    progress_.Tell(fmt::format("{} robots in this process, ready after {:.2f} s", robots_, startup_seconds));
  }
  void OnStatus(const StatusMessage& status) override { progress_.Update(status); }
  void OnEvent(const Event& event, const std::string& text) override {
    progress_.TellEvent(event.tick, ToString(event.type), text);
  }
  void OnNotice(const std::string& text) override { progress_.Tell(text); }

 private:
  std::size_t robots_;
  NewAgents& new_agents_;
  Progress progress_;
};

std::unique_ptr<Transport> MakeTransport(const std::string& faults) {
  std::unique_ptr<Transport> transport = MakeMemoryTransport();
  if (faults.empty()) return transport;
  return MakeFaultyTransport(std::move(transport), ParseFaults(faults).value());
}

// Waits until `done` is readable; asks to stop when a signal says so, and ends at once when it is said twice.
void WaitForEnd(int done, SignalWatch& signals, std::atomic<bool>& stop) {
  pollfd waited[] = {{signals.descriptor(), POLLIN, 0}, {done, POLLIN, 0}};
  while (waited[1].revents == 0) {
    poll(waited, 2, -1);
    if (!signals.TakeStopRequest()) continue;
    if (stop) std::_Exit(kExitInterrupted);
    stop = true;
  }
}

double PeakMemoryMib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

RunEnd RunInProcess(const RunOptions& options) {
  LoadOverrides overrides;
  overrides.seed = options.seed;
  if (!options.controller.empty()) overrides.controller = options.controller;
  Result<LoadedWorld> loaded = LoadWorld(options.file, overrides);
  if (!loaded.ok()) return {kExitBadInput, std::nullopt, loaded.error()};
  for (const Warning& warning : loaded.value().warnings) fmt::print(stderr, "{}\n", warning.ToString());

  ServiceOptions service_options;
  service_options.settings = loaded.value().settings;
  ApplyTo(service_options.settings, options);
  service_options.outputs = {options.hash_log, options.poses, options.record};
  service_options.session = options.session;
  service_options.lease_seconds = options.lease_seconds;
  service_options.start_timeout_seconds = options.start_timeout_seconds;
  service_options.start_paused = options.paused;
  service_options.world_file = options.file;
  service_options.overrides = overrides;
  AgentOptions agent_options;
  agent_options.agent = 1;
  agent_options.scan_log = options.scans;
  agent_options.threads = std::max(1u, std::thread::hardware_concurrency());
  OutputParts trace_parts(options.trace, "--trace");
  std::vector<std::string> trace_files;
  for (TraceOptions* trace : {&service_options.trace, &agent_options.trace}) {
    if (options.trace.empty()) break;
    if (!options.trace_ticks.empty()) *trace = ParseTraceTicks(options.trace_ticks).value();
    Result<std::string> part = trace_parts.Add();
    if (!part.ok()) return {kExitFailed, std::nullopt, part.error()};
    trace->file = part.value();
    trace_files.push_back(part.value());
  }
  if (service_options.settings.ros) {
    service_options.make_gateway = MakeRosWorldGateway(options.ros.options);
    agent_options.make_gateway = MakeRosGateway(options.ros.options);
  }

  Scene scene(std::move(loaded.value().world));
  SignalWatch signals;
  std::unique_ptr<Transport> transport = MakeTransport(options.faults);
  std::atomic<bool> stop = false;
  int done = eventfd(0, EFD_CLOEXEC);
  Result<RunSummary> summary = Error{{}, "the run did not end"};
  Result<bool> agent = false;
  bool bad_request = false;
  NewAgents new_agents(*transport, agent_options);
  std::thread service_thread([&] {
    ProgressObserver observer(scene.world().robots.size(), new_agents);
    summary = RunService(scene, service_options, transport->MakeServiceEndpoint(), observer, stop);
    eventfd_write(done, 1);
  });
  std::atomic<bool> agent_stop = false;
  std::thread agent_thread([&] {
    agent = RunAgent(transport->MakeAgentEndpoint(agent_options.agent), agent_options, agent_stop, &bad_request);
    if (!agent.ok()) stop = true;  // without its only agent the run cannot go on
  });
  WaitForEnd(done, signals, stop);
  service_thread.join();
  if (!summary.ok()) agent_stop = true;
  agent_thread.join();
  new_agents.Join();
  close(done);

  if (!summary.ok()) return {kExitFailed, std::nullopt, summary.error()};
  if (!agent.ok()) return {bad_request ? kExitBadInput : kExitFailed, std::nullopt, agent.error()};
  if (!options.trace.empty()) {
    if (Status failure = MergeTraces(trace_files, options.trace)) return {kExitFailed, std::nullopt, failure};
  }
  if (Status failure = new_agents.MergeScans()) return {kExitFailed, std::nullopt, failure};
  RunOutcome outcome;
  outcome.run = summary.value();
  outcome.service_peak_memory_mib = PeakMemoryMib();
  return {outcome.run.interrupted ? kExitInterrupted : kExitDone, outcome, std::nullopt};
}

}  // namespace troupe
