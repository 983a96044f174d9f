#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <new>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "command_line/terminal.h"
#include "common/base/file.h"
#include "common/base/or_failure.h"
#include "common/base/print.h"
#include "common/base/source_text.h"
#include "common/base/thread_pool.h"
#include "common/base/wake_event.h"
#include "common/trace/tick_trace.h"
#include "launcher/process/process.h"
#include "launcher/supervise/output_files.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/run_ways.h"
#include "robot-agent/agent/agent_host.h"
#include "robot-agent/ros/ros_gateway.h"
#include "ros/link/host_program.h"
#include "transport/protocol/faulty_transport.h"
#include "transport/protocol/transport.h"
#include "world-service/program/prepared_run.h"

namespace troupe {
namespace {

// Agents for the robots that edits add to the world, each on a thread of its own: an agent waits for frames most of the
// time.
// Start is called on the service's thread, Join and what follows it on that of the run, after the service has ended.
class NewAgents {
 public:
  // `stop_run` is set when the scans of an agent cannot be written.
  NewAgents(Transport& transport, AgentOptions options, std::atomic<bool>& stop_run)
      : transport_(transport),
        options_(std::move(options)),
        stop_run_(stop_run),
        scan_parts_(options_.scan_log, "--scans") {
    options_.trace = {};  // the first agent's
  }
  ~NewAgents() { Join(); }

  void Start(const std::vector<std::string>& robots) {
    AgentOptions options = options_;
    options.agent = ++options_.agent;
    options.robots = robots;
    options.skip_unavailable = true;  // they may be deleted before the agent has joined
    if (!options.scan_log.empty()) {
      const Result<std::string> file = scan_parts_.Add();
      if (!file.ok()) return Tell(file.error().ToString());
      options.scan_log = file.value();
      scan_files_.push_back(file.value());
    }
    // OrFailure: an exception of DDS or of a controller must end this agent, not the process.
    threads_.emplace_back([this, options] {
      const Result<AgentEnd> end =
          OrFailure([&] { return RunAgent(transport_.MakeAgentEndpoint(options.agent), options, stop_.get_token()); });
      if (end.ok()) return;
      const Status reported = OrFailure([&] { return ReactToFailure(options, end.error()); });
      if (!reported.ok()) stop_run_ = true;
    });
  }

  // Stops the agents that have not reached the end of the run.
  void Join() {
    stop_.request_stop();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  // The failure that has set `stop_run`. REQUIRES: Join was called.
  const Status& failure() const { return failure_; }

  // Merges their scans into the file of the first agent. REQUIRES: Join was called.
  Status MergeScans() {
    if (options_.scan_log.empty()) return Status();
    std::error_code unknown;
    const bool has_scans = std::filesystem::exists(options_.scan_log, unknown);
    if (!has_scans) return WriteWholeFile(options_.scan_log, "");  // of a world without robots
    if (scan_files_.empty()) return Status();
    const Result<std::string> all = scan_parts_.Add();
    if (!all.ok()) return all.error();
    scan_files_.insert(scan_files_.begin(), options_.scan_log);
    if (Status failure = troupe::MergeScans(scan_files_, all.value(), LineFile::Space::kKeep); !failure.ok())
      return failure;
    std::error_code failure;
    const auto overwrite = std::filesystem::copy_options::overwrite_existing;
    std::filesystem::copy_file(all.value(), options_.scan_log, overwrite, failure);
    if (failure) return Error{{options_.scan_log}, "cannot write scans: " + failure.message(), ErrorCode::kFailure};
    return Status();
  }

 private:
  static void Tell(const std::string& text) { PrintPlain(stderr, "{}\n", text); }

  // On the thread of an agent.
  Status ReactToFailure(const AgentOptions& agent, const Error& error) {
    if (error.code != ErrorCode::kOutputFailed) {
      Tell("agent of " + agent.robots.front() + ": " + error.ToString());
      return {};
    }
    const std::lock_guard lock(failure_mutex_);
    if (failure_.ok()) failure_ = Error{{options_.scan_log}, error.message, error.code};
    stop_run_ = true;
    return {};
  }

  Transport& transport_;
  AgentOptions options_;  // of the newest agent
  std::atomic<bool>& stop_run_;
  OutputParts scan_parts_;
  std::mutex failure_mutex_;
  Status failure_;
  std::vector<std::string> scan_files_;
  std::stop_source stop_;
  std::vector<std::thread> threads_;
};

// The same lines as of a run over DDS, by the same Progress.
class ProgressObserver : public RunObserver {
 public:
  ProgressObserver(std::size_t robots, NewAgents& new_agents) : robots_(robots), new_agents_(new_agents) {}

  void OnNewRobots(const std::vector<std::string>& robots, Edition) override { new_agents_.Start(robots); }

  void OnStarted(double startup_seconds) override {
    progress_.Tell(
        fmt::format("{} in this process, ready after {:.2f} s", CountText(robots_, "robot"), startup_seconds));
  }
  void OnStatus(const StatusMessage& status) override { progress_.Update(status); }
  void OnEvent(const Event& event, const std::string& text) override {
    progress_.TellEvent(event.tick, NameOf(event.type), text);
  }
  void OnNotice(const std::string& text) override { progress_.Tell(text); }

 private:
  std::size_t robots_;
  NewAgents& new_agents_;
  Progress progress_;
};

// The text was checked when the command line was read.
std::unique_ptr<Transport> MakeTransport(const std::string& faults) {
  std::unique_ptr<Transport> transport = MakeMemoryTransport();
  if (faults.empty()) return transport;
  return MakeFaultyTransport(std::move(transport), ParseFaults(faults).value());
}

// Waits until `done` is readable. The first stop request sets `stop`, the second ends the process.
void WaitForEnd(int done, SignalWatch& signals, std::atomic<bool>& stop) {
  pollfd waited[] = {{signals.descriptor(), POLLIN, 0}, {done, POLLIN, 0}};
  while (waited[1].revents == 0) {
    poll(waited, std::size(waited), -1);
    if (!signals.ReadStopRequest()) continue;
    ClearLine();
    // The second request: without destructors, which might wait for the very thread that hangs.
    if (stop) std::_Exit(kExitInterrupted);
    stop = true;
  }
}

double PeakMemoryMib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// For the step and for the robots, which alternate: threads that have served one are awake for the other.
std::shared_ptr<ThreadPool> MakeThreadPool(const RunOptions& options) {
  return std::make_shared<ThreadPool>(options.threads.value_or(std::thread::hardware_concurrency()));
}

// The same source as world-service makes of its command line, so that both ways load, branch and record alike.
RunSource SourceOf(const RunOptions& options) {
  RunSource source;
  source.file = options.file;
  source.overrides = options.load;
  source.branch = options.branch;
  source.run = options.run;
  source.permissions = options.permissions;
  source.outputs = {options.hash_log, options.poses, options.record, options.keyframe_interval};
  source.ros = options.ros;
  source.fleet = options.fleet;
  ServiceOptions& service = source.service;
  service.session = options.network.session;
  service.lease_seconds = options.network.lease();
  service.start_timeout_seconds = options.start_timeout_seconds;
  service.start_paused = options.paused;
  service.pool = MakeThreadPool(options);
  service.scenes = std::make_shared<SceneCache>();
  return source;
}

// Scenes and libraries are the service's: the world is loaded once in the process.
AgentOptions MakeAgentOptions(const RunOptions& options, const ServiceOptions& service) {
  AgentOptions agent;
  agent.agent = 1;
  agent.scan_log = options.scans;
  agent.pool = service.pool;
  agent.scenes = service.scenes;
  agent.libraries = service.libraries;
  if (service.settings.ros) {
    ros::RosOptions ros = options.ros;
    ros.robots.infinite_ranges = ros.robots.infinite_ranges.value_or(service.settings.ros_infinite_ranges);
    agent.make_gateway = MakeRosGateway(ros);
  }
  return agent;
}

// The service and the first agent in threads of their own.
// The threads share the transport alone. Members are declared in the order of use: the transport outlives the viewer
// and the agents, which have endpoints of it.
class InProcessRun {
 public:
  // The run and its observers must outlive this.
  InProcessRun(const PreparedRun& run, const std::string& faults, AgentOptions agent, RunObservers observers)
      : run_(run),
        agent_options_(std::move(agent)),
        observers_(std::move(observers)),
        transport_(MakeTransport(faults)),
        new_agents_(*transport_, agent_options_, stop_) {}

  void AddViewer(const MakeViewer& make_viewer) {
    viewer_ = make_viewer(*transport_, run_.options.scenes);
    observers_.push_back(viewer_.get());
  }

  // Runs until service and agents have ended, and merges the scans.
  // `summary` and `agent` are written by their threads and read after the joins.
  Result<RunSummary> Run(SignalWatch& signals) {
    const WakeEvent done;
    std::stop_source agent_stop;
    Result<RunSummary> summary = Failure("the run did not end");
    Result<AgentEnd> agent = AgentEnd::kStopped;
    std::thread service_thread([&] {
      summary = OrFailure([&] {
        ProgressObserver progress(run_.world().robots.size(), new_agents_);
        observers_.push_back(&progress);
        return RunService(run_.scene, run_.options, transport_->MakeServiceEndpoint(), observers_, stop_);
      });
      done.Signal();
    });
    std::thread agent_thread;  // of the robots at the start, if there are any
    const auto run_agent = [&] {
      agent = OrFailure([&] {
        return RunAgent(transport_->MakeAgentEndpoint(agent_options_.agent), agent_options_, agent_stop.get_token());
      });
      if (!agent.ok()) stop_ = true;  // without its only agent the run cannot continue
    };
    try {
      if (!run_.world().robots.empty()) agent_thread = std::thread(run_agent);
    } catch (const std::system_error& error) {
      agent = Failure(std::string("cannot start a thread: ") + error.what());
      stop_ = true;
    } catch (const std::bad_alloc& error) {
      agent = FailureOf(error);
      stop_ = true;
    }
    WaitForEnd(done.descriptor(), signals, stop_);
    service_thread.join();
    if (!summary.ok()) agent_stop.request_stop();
    if (agent_thread.joinable()) agent_thread.join();
    new_agents_.Join();
    if (!summary.ok()) return summary.error();
    if (!agent.ok()) return agent.error();
    if (!new_agents_.failure().ok()) return new_agents_.failure().error();
    if (Status status = new_agents_.MergeScans(); !status.ok()) return status.error();
    return summary;
  }

 private:
  const PreparedRun& run_;
  const AgentOptions agent_options_;
  RunObservers observers_;
  const std::unique_ptr<Transport> transport_;
  std::unique_ptr<RunObserver> viewer_;  // may be null
  std::atomic<bool> stop_ = false;
  NewAgents new_agents_;
};

// Gives the service and the agent a part of the trace each.
// Two parts, because service and agent append at the same time.
Result<std::vector<std::string>> SplitTrace(const TraceOptions& trace, OutputParts& parts, TraceOptions& service,
                                            TraceOptions& agent) {
  std::vector<std::string> files;
  if (trace.file.empty()) return files;
  for (TraceOptions* part : {&service, &agent}) {
    Result<std::string> file = parts.Add();
    if (!file.ok()) return file.error();
    *part = trace;
    part->file = file.value();
    files.push_back(std::move(file).value());
  }
  return files;
}

// An error about a part of the trace is one about the user's file.
Error WithUsersFile(Error error, const std::vector<std::string>& parts, const std::string& file) {
  if (std::find(parts.begin(), parts.end(), error.where.file) != parts.end()) error.where.file = file;
  return error;
}

}  // namespace

// The error of a step is part of the RunEnd: the report of the end is that of a run over DDS.
int RunInProcess(const RunOptions& options, const MakeViewer& make_viewer, const ReportEnd& report) {
  RunSource source = SourceOf(options);
  TraceOptions agent_trace;
  OutputParts trace_parts(options.trace.file, "--trace");
  const auto trace_files = SplitTrace(options.trace, trace_parts, source.service.trace, agent_trace);
  if (!trace_files.ok()) return report(FailedRun(trace_files.error()));
  // Outlives the connections of the run to it, and so awaits its end.
  ros::HostProgram ros_program(options.ros.socket, options.ros.network, ros::HostProgram::AtEnd::kAwait,
                               [](const std::string& line) { PrintPlain(stderr, "{}\n", line); });
  Result<PreparedRun> prepared = PrepareRun(source);
  if (!prepared.ok()) return report(FailedRun(prepared.error()));
  AgentOptions agent = MakeAgentOptions(options, prepared.value().options);
  agent.trace = agent_trace;
  SignalWatch signals;
  if (prepared.value().options.settings.ros) {
    const Status started = ros_program.Start();
    if (!started.ok()) return report(FailedRun(started.error()));
  }
  Result<RunObservers> observers = MakeObservers(prepared.value(), source);
  if (!observers.ok()) return report(FailedRun(observers.error()));

  InProcessRun run(prepared.value(), options.faults, std::move(agent), std::move(observers).value());
  if (!options.headless) run.AddViewer(make_viewer);
  const Result<RunSummary> summary = run.Run(signals);
  const Status merged = options.trace.file.empty() ? Status() : MergeTraces(trace_files.value(), options.trace.file);
  if (!summary.ok()) return report(FailedRun(WithUsersFile(summary.error(), trace_files.value(), options.trace.file)));
  if (!merged.ok()) return report(FailedRun(merged.error()));
  RunOutcome outcome;
  outcome.run = summary.value();
  outcome.service_peak_memory_mib = PeakMemoryMib();
  const RunEnd end = {ExitStatusOf(outcome.run), outcome, std::nullopt};
  const int exit_status = report(end);
  if (StaysOpen(options, end)) {
    Progress progress;
    AwaitStopOfViewer(signals, progress);
  }
  return exit_status;
}

}  // namespace troupe
