#include "launcher/distributed_run.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <utility>

#include "common/trace/trace_file.h"
#include "launcher/agent_fleet.h"
#include "launcher/far_machine.h"
#include "launcher/local_machine.h"
#include "launcher/merge_scans.h"
#include "launcher/network_address.h"
#include "launcher/output_parts.h"
#include "launcher/place_robots.h"
#include "launcher/progress.h"
#include "launcher/service_report.h"
#include "launcher/signal_watch.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// How long a process may take to end after it was told to, before it is killed.
constexpr auto kTimeToEnd = std::chrono::seconds(10);
// The same for agents after the service has ended the run: they leave at once unless they hang.
constexpr auto kTimeToLeave = std::chrono::seconds(5);
// For the first word from another machine.
constexpr auto kTimeToConnect = std::chrono::seconds(30);

class DistributedRun {
 public:
  explicit DistributedRun(const RunOptions& options)
      : options_(options), agents_(options), trace_parts_(options.trace, "--trace") {}

  RunEnd Run();

 private:
  Status ConnectHosts();
  Status StartService();
  // Paths for the service's output, where it runs.
  RunOptions ServiceOptions() const;
  Status FetchOutputs();
  Machine& ServiceMachine() const { return *(service_host_ ? machines_[1 + *service_host_] : machines_[0]); }
  void Watch();
  void WaitForAgents();
  // Handles whatever happened, after waiting for it at most until the deadline.
  void HandleSome();
  void HandleReports();
  void Handle(const ReadyReport& ready);
  void Handle(const NewRobotsReport& report);
  void Handle(const StartedReport&);
  // Which site each robot goes to.
  Result<std::vector<std::size_t>> Place(const std::vector<std::string>& robots) const;
  void Handle(const StatusMessage& status);
  void Handle(const EventReport& event) { progress_.TellEvent(event.tick, event.event, event.text); }
  void Handle(const RunSummary& summary) { summary_ = summary; }
  void HandleOutput();
  void HandleEnded(const AgentProcess& agent);
  Status MergeAllTraces();
  void Stop();
  void Fail(int exit_status, std::optional<Error> error);
  RunEnd End();

  const RunOptions& options_;
  SignalWatch signals_;
  std::vector<std::unique_ptr<Machine>> machines_;  // this one, and then the hosts
  std::optional<std::size_t> service_host_;
  Progress progress_;
  std::unique_ptr<Child> service_;
  AgentFleet agents_;
  OutputParts trace_parts_;    // the service's; the agents' are with them
  std::string service_trace_;  // empty: none
  Clock::time_point start_ = Clock::now();
  std::optional<Clock::time_point> kill_at_;  // set when told to stop
  std::size_t robots_ = 0;
  double startup_seconds_ = 0.0;
  bool started_ = false;
  bool error_told_ = false;  // by a child
  bool interrupted_ = false;
  std::optional<RunSummary> summary_;
  int exit_status_ = kExitDone;
  std::optional<Error> error_;
};

Status DistributedRun::ConnectHosts() {
  // On the loopback interface nobody else reaches the agents.
  const bool alone = options_.network_interface == "lo";
  machines_.push_back(std::make_unique<LocalMachine>(alone ? Addresses::kSame : Addresses::kRandom));
  Result<std::vector<std::unique_ptr<FarMachine>>> hosts =
      ConnectAll(options_.hosts, kTimeToConnect, signals_, &interrupted_);
  if (!hosts.ok()) return hosts.error();
  for (std::unique_ptr<FarMachine>& host : hosts.value()) machines_.push_back(std::move(host));
  for (std::size_t i = 0; i < options_.hosts.size(); ++i) {
    if (options_.hosts[i].service) service_host_ = i;
  }
  return std::nullopt;
}

RunOptions DistributedRun::ServiceOptions() const {
  RunOptions options = options_;
  options.trace = service_trace_;
  if (!service_host_) return options;
  options.network_interface = InterfaceOf(options_.hosts[*service_host_]);
  options.file = std::filesystem::absolute(options_.file).lexically_normal().string();
  const std::string folder = ServiceMachine().folder() + "/service-";
  if (!options.hash_log.empty()) options.hash_log = folder + "hashes";
  if (!options.poses.empty()) options.poses = folder + "poses";
  if (!options.record.empty()) options.record = folder + "record";
  if (!options.trace.empty()) options.trace = folder + "trace";
  return options;
}

Status DistributedRun::FetchOutputs() {
  if (service_host_) {
    const RunOptions there = ServiceOptions();
    const std::pair<const std::string&, const std::string&> files[] = {{there.hash_log, options_.hash_log},
                                                                       {there.poses, options_.poses},
                                                                       {there.record, options_.record},
                                                                       {there.trace, service_trace_}};
    for (const auto& [from, to] : files) {
      if (to.empty()) continue;
      if (Status failure = ServiceMachine().Fetch(from, to)) return failure;
    }
  }
  return agents_.FetchOutputs();
}

Status DistributedRun::StartService() {
  if (!options_.trace.empty()) {
    Result<std::string> part = trace_parts_.Add();
    if (!part.ok()) return part.error();
    service_trace_ = part.value();
  }
  Result<std::unique_ptr<Child>> service =
      ServiceMachine().Start("world-service", ServiceArguments(ServiceOptions()), true);
  if (!service.ok()) return service.error();
  service_ = std::move(service).value();
  return std::nullopt;
}

void DistributedRun::HandleSome() {
  int timeout = -1;
  if (kill_at_) {
    auto left = std::chrono::duration_cast<std::chrono::milliseconds>(*kill_at_ - Clock::now());
    timeout = std::max(0, static_cast<int>(left.count()) + 1);
  }
  std::vector<pollfd> waited = {{signals_.descriptor(), POLLIN, 0}};
  for (const auto& machine : machines_) {
    for (int descriptor : machine->descriptors()) waited.push_back({descriptor, POLLIN, 0});
  }
  poll(waited.data(), waited.size(), timeout);
  if (signals_.TakeStopRequest()) {
    if (interrupted_) kill_at_ = Clock::now();  // asked twice: at once
    interrupted_ = true;
    Stop();
  }
  // Whether the service has ended is asked before its last words are read, so that none are missed.
  service_->Poll();
  HandleOutput();
  HandleReports();
  for (const AgentProcess* agent : agents_.TakeEnded()) HandleEnded(*agent);
  if (kill_at_ && Clock::now() >= *kill_at_) {
    service_->Kill();
    agents_.Kill();
  }
}

void DistributedRun::HandleOutput() {
  for (const auto& machine : machines_) {
    for (const std::string& line : machine->TakeOutput()) {
      // Of a hundred agents with the same trouble at the start one is enough.
      bool error = line.starts_with("error: ") || line.find(": error: ") != std::string::npos;
      if (error && error_told_ && !started_) continue;
      error_told_ = error_told_ || error;
      progress_.Tell(machine->name().empty() ? line : machine->name() + ": " + line);
    }
    if (Status loss = machine->TakeLoss(); loss && !summary_) progress_.Tell(loss->ToString());
  }
}

void DistributedRun::HandleReports() {
  for (const std::string& line : ServiceMachine().TakeReports()) {
    std::optional<ServiceReport> report = ParseServiceReport(line);
    if (report) std::visit([this](const auto& content) { Handle(content); }, *report);
  }
}

void DistributedRun::Handle(const ReadyReport& ready) {
  if (kill_at_) return;
  robots_ = ready.robots.size();
  std::vector<AgentSite> sites;
  for (std::size_t i = 0; i < options_.hosts.size(); ++i) {
    sites.push_back({machines_[1 + i].get(), InterfaceOf(options_.hosts[i])});
  }
  if (sites.empty()) sites.push_back({machines_[0].get(), options_.network_interface});
  const Result<std::vector<std::size_t>> places = Place(ready.robots);
  if (!places.ok()) return Fail(kExitBadInput, places.error());
  std::string address =
      service_host_ ? options_.hosts[*service_host_].address : LocalAddress(options_.network_interface);
  address += ":" + std::to_string(ready.port);
  if (Status failure = agents_.Start(ready, address, sites, places.value())) {
    Fail(kExitFailed, failure);
  }
}

Result<std::vector<std::size_t>> DistributedRun::Place(const std::vector<std::string>& robots) const {
  if (options_.hosts.empty()) return std::vector<std::size_t>(robots.size(), 0);
  return PlaceRobots(robots, options_.hosts);
}

// The service waits for the agents, and says so if they do not come: that is no reason to end the run.
void DistributedRun::Handle(const NewRobotsReport& report) {
  if (kill_at_) return;
  const Result<std::vector<std::size_t>> places = Place(report.robots);
  if (!places.ok()) return progress_.Tell(places.error().ToString());
  if (Status failure = agents_.Add(report.robots, places.value())) progress_.Tell(failure->ToString());
}

void DistributedRun::Handle(const StatusMessage& status) {
  progress_.Update(status);
  if (started_ || kill_at_) return;
  if (Status failure = agents_.TakeJoined(status.agents)) Fail(kExitFailed, failure);
}

void DistributedRun::Handle(const StartedReport&) {
  started_ = true;
  startup_seconds_ = std::chrono::duration<double>(Clock::now() - start_).count();
  const std::string on_hosts = options_.hosts.empty() ? "" : fmt::format(" on {} hosts", options_.hosts.size());
  progress_.Tell(fmt::format("session {}: {} robots in {} agent processes{}, ready after {:.2f} s", options_.session,
                             robots_, agents_.size(), on_hosts, startup_seconds_));
}

void DistributedRun::HandleEnded(const AgentProcess& agent) {
  const ProcessEnd& end = *agent.process->end();
  if (end.ok() || kill_at_ || summary_ || !service_->running()) return;
  std::string text = (agent.robots.size() == 1 ? "robot " : "robots ");
  for (const std::string& robot : agent.robots) text += (&robot == &agent.robots.front() ? "" : ", ") + robot;
  const std::string& host = agent.machine->name();
  const std::string on_host = host.empty() ? "" : "on host " + host + ", ";
  text += ": the agent (" + on_host + "process " + std::to_string(agent.process->pid()) + ") " + end.ToString();
  if (started_) {
    progress_.Tell(text + "; to start it again" + (host.empty() ? "" : " there") + ":\n  " + agent.restart_command);
  } else if (end.exit_code == kExitBadInput || end.exit_code == kExitFailed) {
    Fail(end.exit_code, std::nullopt);  // it has said why
  } else {
    Fail(kExitFailed, Error{{}, text + " before the run began"});
  }
}

void DistributedRun::Fail(int exit_status, std::optional<Error> error) {
  if (exit_status_ != kExitDone) return;
  exit_status_ = exit_status;
  error_ = std::move(error);
  Stop();
}

void DistributedRun::Stop() {
  service_->Signal(SIGTERM);
  if (!started_) agents_.Signal(SIGTERM);
  if (!kill_at_) kill_at_ = Clock::now() + kTimeToEnd;
}

void DistributedRun::Watch() {
  while (service_->running()) HandleSome();
  HandleReports();
  if (exit_status_ != kExitDone) return;
  const ProcessEnd& end = *service_->end();
  if (end.exit_code == kExitBadInput || end.exit_code == kExitFailed) {
    exit_status_ = end.exit_code;  // it has said why
  } else if (interrupted_) {
    exit_status_ = kExitInterrupted;
  } else if (!end.ok() || !summary_) {
    exit_status_ = kExitFailed;
    const std::string where = service_host_ ? "on host " + ServiceMachine().name() + " " : "";
    error_ = Error{{}, "the world service " + where + end.ToString()};
  }
}

void DistributedRun::WaitForAgents() {
  // After an orderly end they leave by themselves, once they have written what they have to write.
  if (!summary_) agents_.Signal(SIGTERM);
  kill_at_ = Clock::now() + kTimeToLeave;
  while (!agents_.all_ended()) HandleSome();
  HandleOutput();
}

Status DistributedRun::MergeAllTraces() {
  if (!started_ || options_.trace.empty()) return std::nullopt;
  std::vector<std::string> parts = {service_trace_};
  parts.insert(parts.end(), agents_.trace_files().begin(), agents_.trace_files().end());
  return MergeTraces(parts, options_.trace);
}

RunEnd DistributedRun::End() {
  RunEnd end;
  end.exit_status = exit_status_;
  end.error = error_;
  // Scans of a run that failed half-way may tell why.
  Status unfetched = started_ && !options_.hosts.empty() ? FetchOutputs() : Status();
  Status unmerged = started_ && !options_.scans.empty() ? MergeScans(agents_.scan_files(), options_.scans) : Status();
  if (Status failure = MergeAllTraces(); failure && !unmerged) unmerged = failure;
  bool failed = exit_status_ != kExitDone && exit_status_ != kExitInterrupted;
  if (unmerged && !failed) return {kExitFailed, std::nullopt, unmerged};
  if (unfetched && !failed) return {kExitFailed, std::nullopt, unfetched};
  if (!summary_ || failed) return end;
  end.outcome.emplace();
  end.outcome->run = *summary_;
  end.outcome->run.startup_seconds = startup_seconds_;
  end.outcome->processes = static_cast<std::uint32_t>(agents_.size() + 1);
  end.outcome->service_peak_memory_mib = service_->end()->peak_memory_mib;
  end.outcome->hosts = agents_.hosts();
  end.outcome->agent_peak_memory_mib = agents_.peak_memory_mib();
  return end;
}

RunEnd DistributedRun::Run() {
  if (Status failure = ConnectHosts()) {
    return {interrupted_ ? kExitInterrupted : kExitFailed, std::nullopt, failure};
  }
  if (Status failure = StartService()) return {kExitFailed, std::nullopt, failure};
  Watch();
  WaitForAgents();
  return End();
}

}  // namespace

RunEnd RunDistributed(const RunOptions& options) {
  signal(SIGPIPE, SIG_IGN);  // a connection to a host may be lost while something is said to it
  return DistributedRun(options).Run();
}

}  // namespace troupe
