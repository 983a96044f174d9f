#include "launcher/supervise/distributed_run.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <utility>

#include "command_line/terminal.h"
#include "common/base/source_text.h"
#include "launcher/supervise/collect_outputs.h"

namespace troupe {
namespace {

// A process that has not ended this long after the request to stop is killed.
constexpr auto kStopTimeout = std::chrono::seconds(10);
// The same for agents after the end of the service: they leave at once unless they hang.
constexpr auto kLeaveTimeout = std::chrono::seconds(5);

// Network profiles (transport/dds/binding/domain_config.h).
constexpr const char* kMulticastProfile = "lan";

}  // namespace

// Without a time to wake at, the wait is unlimited: an idle run costs no processor time.
void DistributedRun::WaitForEvents() {
  std::optional<double> wake = restarts_.NextDue();
  if (service_restarts_.due()) wake = std::min(wake.value_or(*service_restarts_.due()), *service_restarts_.due());
  if (const std::optional<double> next = hosts_.NextReconnect()) wake = std::min(wake.value_or(*next), *next);
  if (!options_.hosts.empty()) wake = std::min(wake.value_or(next_ping_), next_ping_);
  for (const std::optional<Clock::time_point>& at : {stop_agents_at_, kill_at_}) {
    if (at) wake = std::min(wake.value_or(Seconds(*at)), Seconds(*at));
  }
  const int timeout = wake ? std::max(0, static_cast<int>(1000.0 * (*wake - Seconds(Clock::now()))) + 1) : -1;
  std::vector<pollfd> waited = {{signals_.descriptor(), POLLIN, 0}};
  for (const int descriptor : hosts_.descriptors()) waited.push_back({descriptor, POLLIN, 0});
  poll(waited.data(), waited.size(), timeout);
}

// The order of the steps matters: ends before output, output before reports, reports before reactions to ends.
void DistributedRun::ProcessEvents() {
  WaitForEvents();
  // The first Ctrl-C asks for an orderly end, with summary and files; the second one kills.
  const bool second_request = signals_.stop_requested();
  if (signals_.ReadStopRequest()) {
    progress_.OnStopRequest();
    if (second_request) kill_at_ = Clock::now();
    Stop();
  }
  // The ends of processes are polled before their last lines are read, so that none are missed.
  for (const auto& host : hosts_.all()) host->Receive();
  service_.process().Poll();
  // Decided before the reports are read, acted on after them: the last reports of a service say whether its run had
  // ended.
  const bool dies = !service_.process().running() && !service_restarts_.due();
  // Hundreds of agents are not polled for each report of the service. The ends of those on remote hosts are messages.
  std::vector<std::size_t> ended;
  if (signals_.ReadChildEnd() || !options_.hosts.empty()) ended = agents_.PollEnded();
  const Status viewer = viewer_.Poll();
  PrintOutput();
  if (!viewer.ok()) progress_.Tell(viewer.error().message);
  ProcessReports();
  if (dies) PlanRestartOfService();
  TellAgents(ended);
  PingHosts();
  for (const std::size_t agent : ended) ReactToEnd(agents_.agent(agent));
  RestartService();
  ReconnectHosts();
  RestartAgents();
  if (stop_agents_at_ && Clock::now() >= *stop_agents_at_) {
    agents_.Signal(SIGTERM);
    stop_agents_at_.reset();
  }
  if (kill_at_ && Clock::now() >= *kill_at_) {
    service_.process().Kill();
    agents_.Kill();
    viewer_.Kill();
  }
}

void DistributedRun::PrintOutput() {
  for (const auto& host : hosts_.all()) {
    for (const std::string& line : host->ReadOutput()) {
      if (NoteOutputFailure(line, *host) || NotePage(line, *host)) continue;
      // Before the start, one error represents the errors of all agents, which usually have the same cause.
      const bool error = line.starts_with("error: ") || line.find(": error: ") != std::string::npos;
      if (error && error_printed_ && !started_) continue;
      error_printed_ = error_printed_ || error;
      progress_.Tell(host->name().empty() ? line : host->name() + ": " + line);
    }
    if (hosts_.is_lost(*host)) continue;  // of an attempt to connect again
    if (const Status loss = host->PollLoss(); !loss.ok()) ReactToLoss(*host, loss.error());
  }
  const std::lock_guard lock(ros_mutex_);
  for (const std::string& line : std::exchange(ros_lines_, {})) progress_.Tell(line);
}

// A request for another run counts only from this host and after the run's summary; before, it is a line as any other.
bool DistributedRun::NotePage(const std::string& line, const Host& host) {
  if (!host.name().empty()) return false;
  if (page_.empty() && line.starts_with(kPageLine)) page_ = line.substr(kPageLine.size());
  if (!summary_ || page_.empty()) return false;
  const std::optional<std::optional<std::uint64_t>> seed = ParseRunAgainLine(line);
  if (seed) again_ = NewRun{*seed, page_};
  return seed.has_value();
}

// Every process whose disk is full prints a line. The first one becomes the error of the run.
bool DistributedRun::NoteOutputFailure(const std::string& line, const Host& host) {
  if (line.find(": error: ") == std::string::npos) return false;
  std::optional<Error> failure = agents_.OutputFailureIn(line, host);
  if (!failure) failure = service_.OutputFailureIn(line);
  if (!failure) return false;
  if (!output_failure_) output_failure_ = std::move(failure);
  return true;
}

// A line that is no report is skipped (launcher/supervise/reports.h).
void DistributedRun::ProcessReports() {
  for (const std::string& line : hosts_.service_host().ReadReports()) {
    std::optional<ServiceReport> report = ParseServiceReport(line);
    if (report) std::visit([this](const auto& content) { React(content); }, *report);
  }
}

// The service knows the robots only once the world is loaded: nothing about agents is decided before this report. A
// second one is that of a restarted service.
void DistributedRun::React(const ReadyReport& ready) {
  if (kill_at_) return;
  if (!service_ports_.empty()) return ReactToReturn(ready);
  std::vector<std::string> addresses;
  for (const ServiceParticipant& of_group : ready.participants) {
    service_ports_.push_back(of_group.port);
    addresses.push_back(hosts_.ServiceAddress(of_group.port));
  }
  robots_ = ready.robots.size();
  // A run that ends when an agent is lost has no time for a restart.
  rebuilds_ = ready.rebuilds_on_loss;
  if (!ready.aborts_on_loss) {
    restarts_ = AgentRestarts(options_.restart_agents.value_or(ready.restart_agents));
  }
  const Result<std::vector<std::size_t>> sites = hosts_.PlaceOnSites(ready.robots);
  if (!sites.ok()) return Fail(FailedRun(sites.error()));
  Status started = agents_.Start(ready, addresses, hosts_.AgentSites(), sites.value());
  if (started.ok()) started = StartRosProgram(ready);
  if (!started.ok()) return Fail(FailedRun(started.error()));
  StartViewer();
}

// The agents that live find the service by themselves.
void DistributedRun::ReactToReturn(const ReadyReport& ready) {
  agents_.SetService(ready.participants);
  for (std::size_t number = 0; number < agents_.started(); ++number) {
    const AgentProcess& agent = agents_.agent(number);
    if (agent.process->running()) service_.TellStart(agent.id);
  }
}

// Without a viewer the run is the same.
void DistributedRun::StartViewer() {
  if (options_.headless) return;
  const Status started = viewer_.Start(*hosts_.all().front(), options_, hosts_.ServiceAddress(service_ports_.front()),
                                       keys_, service_.JournalOptions());
  if (!started.ok()) progress_.Tell("cannot start the viewer: " + started.error().message);
}

// While the agents start. Those on other hosts, and those with keys, start a program themselves.
Status DistributedRun::StartRosProgram(const ReadyReport& ready) {
  const bool is_needed_here = options_.hosts.empty() || hosts_.service_settings() == nullptr;
  if (!ready.ros || options_.ros.socket.empty() || !is_needed_here) return Status();
  ros_program_.emplace(options_.ros.socket, options_.ros.network, ros::HostProgram::AtEnd::kAwait,
                       [this](const std::string& line) {
                         const std::lock_guard lock(ros_mutex_);
                         ros_lines_.push_back(line);
                       });
  return ros_program_->Start();
}

// An error here does not end the run: the service waits for the agents, and reports those that do not join.
void DistributedRun::React(const NewRobotsReport& report) {
  if (kill_at_ || report.edition <= new_robots_edition_) return;  // a service that died has reported it
  new_robots_edition_ = report.edition;
  const Result<std::vector<std::size_t>> sites = hosts_.PlaceOnSites(report.robots);
  if (!sites.ok()) return progress_.Tell(sites.error().ToString());
  if (Status status = agents_.Add(report.robots, sites.value()); !status.ok()) {
    progress_.Tell(status.error().ToString());
  }
}

// Joins are counted in statuses: each lets further agents start (AgentFleet::StartAfterJoins).
void DistributedRun::React(const StatusMessage& status) {
  progress_.Update(status);
  if (!begins_at_) begins_at_ = status.sim_seconds;
  newest_ = {status.edition, status.tick};
  if (started_ || kill_at_) return;
  if (Status started = agents_.StartAfterJoins(status.agents); !started.ok()) Fail(FailedRun(started.error()));
}

// The start-up time is measured by this process: it includes the starts of all processes.
void DistributedRun::React(const StartedReport&) {
  service_started_at_ = Clock::now();
  if (started_) return progress_.Tell("the world service has been started again, and the run continues");
  started_ = true;
  started_at_ = service_started_at_;
  startup_seconds_ = std::chrono::duration<double>(Clock::now() - start_).count();
  const std::string on_hosts = options_.hosts.empty() ? "" : fmt::format(" on {} hosts", options_.hosts.size());
  progress_.Tell(fmt::format("session {}: {} in {} agent {}{}, ready after {:.2f} s", options_.network.session,
                             CountText(robots_, "robot"), agents_.size(), agents_.size() == 1 ? "process" : "processes",
                             on_hosts, startup_seconds_));
}

void DistributedRun::Fail(RunEnd end) {
  if (failed()) return;
  end_ = std::move(end);
  Stop();
}

// SIGTERM to the service alone once the run has started: it tells the agents of the end, so that all stop at the same
// tick.
void DistributedRun::Stop() {
  service_restarts_.Cancel();
  service_.process().Signal(SIGTERM);
  if (!started_) agents_.Signal(SIGTERM);
  if (!kill_at_) kill_at_ = Clock::now() + kStopTimeout;
}

// A profile that the user has named stays, but for lan, which would not work without multicast.
void DistributedRun::ChooseNetworkProfile() {
  std::string& profile = options_.network.network_profile;
  if (!profile.empty() && profile != kMulticastProfile) return;
  const std::vector<std::string> deaf = hosts_.WithoutMulticast(signals_);
  if (deaf.empty()) return;
  profile = kUnicastProfile;
  const Host& service_host = hosts_.service_host();
  const std::string name = service_host.name().empty() ? "this host" : "host " + service_host.name();
  progress_.Tell(
      fmt::format("multicast from {} does not reach {} {}: the run uses the network profile unicast instead of "
                  "lan, and sends each frame to each agent",
                  name, deaf.size() == 1 ? "host" : "hosts", fmt::join(deaf, ", ")));
}

// The service decides when a run ends; agents that end before it are restarted or lost.
void DistributedRun::SuperviseUntilServiceEnds() {
  while (goes_on()) ProcessEvents();
  ProcessReports();
  if (failed()) return;
  const ProcessEnd& end = *service_.process().end();
  if (end.exit_code == kExitBadInput || end.exit_code == kExitFailed) {
    end_ = {end.exit_code, std::nullopt, output_failure_};
  } else if (signals_.stop_requested()) {
    end_ = {kExitInterrupted, std::nullopt, std::nullopt};
  } else if (!summary_ || (!end.ok() && end.signal == 0)) {  // after the summary no death changes anything
    const std::string& host = hosts_.service_host().name();
    end_ = FailedRun(Failure("the world service " + (host.empty() ? "" : "on host " + host + " ") + end.ToString()));
  }
}

void DistributedRun::AwaitProcesses() {
  // After an orderly end of the service the agents leave by themselves, once they have written their files; but its
  // last messages may be lost.
  if (summary_) {
    stop_agents_at_ = Clock::now() + kLeaveTimeout;
    kill_at_ = *stop_agents_at_ + kStopTimeout;
  } else {
    agents_.Signal(SIGTERM);
    kill_at_ = Clock::now() + kLeaveTimeout;
  }
  while (!agents_.all_ended()) ProcessEvents();
  stop_agents_at_.reset();
  ros_program_.reset();  // after the agents, whose last samples it passes on
  PrintOutput();
}

// The last service knows its own time alone.
void DistributedRun::CountFromTheFirstService(RunSummary& run) const {
  run.wall_seconds += std::chrono::duration<double>(service_started_at_ - started_at_).count();
  if (run.wall_seconds <= 0.0) return;
  run.real_time_factor = (run.sim_seconds - begins_at_.value_or(0.0)) / run.wall_seconds;
}

// A failure of the run precedes one of its outputs, which usually follows from it.
RunEnd DistributedRun::End() {
  const Status collected =
      started_ ? CollectOutputs(options_, hosts_, service_, agents_, signals_, progress_) : Status();
  if (failed()) return end_;
  if (output_failure_) return FailedRun(*output_failure_);
  if (!collected.ok()) return FailedRun(collected.error());
  if (!summary_) return end_;
  RunOutcome outcome;
  outcome.run = *summary_;
  outcome.run.startup_seconds = startup_seconds_;
  if (service_restarts_.count() > 0) CountFromTheFirstService(outcome.run);
  outcome.processes = static_cast<std::uint32_t>(agents_.size() + 1);
  outcome.agents_restarted = restarted_;
  outcome.service_restarted = service_restarts_.count();
  outcome.service_peak_memory_mib = service_.process().end()->peak_memory_mib;
  outcome.hosts = agents_.hosts();
  outcome.missing_files = agents_.missing_files();
  outcome.agent_peak_memory_mib = agents_.peak_memory_mib();
  const int exit_status = end_.exit_status == kExitDone ? ExitStatusOf(outcome.run) : end_.exit_status;
  return {exit_status, std::move(outcome), std::nullopt};
}

void DistributedRun::StopViewer() {
  viewer_.Stop();
  kill_at_ = Clock::now() + kLeaveTimeout;
  while (viewer_.running()) ProcessEvents();
  PrintOutput();
}

void DistributedRun::AwaitStopOfViewer() {
  kill_at_.reset();  // of the agents, which have ended
  const auto stays_open = [&] { return viewer_.running() && !again_ && !signals_.stop_requested(); };
  while (stays_open() && page_.empty()) ProcessEvents();  // a short run may end before its viewer has a page
  if (stays_open()) progress_.Tell(kPageStaysOpen);
  while (stays_open()) ProcessEvents();
}

// The result is reported before the wait for the viewer (launcher/supervise/run_ways.h).
int DistributedRun::Run(const ReportEnd& report) {
  const RunEnd end = Supervise();
  const bool stays_open = viewer_.running() && StaysOpen(options_, end);
  if (!stays_open) StopViewer();
  progress_.End();
  const int exit_status = report(end);
  if (!stays_open) return exit_status;
  AwaitStopOfViewer();
  StopViewer();
  return exit_status;
}

// Hosts first, then keys, which are copied to them, then the service.
RunEnd DistributedRun::Supervise() {
  if (const Status status = hosts_.Connect(signals_); !status.ok()) {
    RunEnd end = FailedRun(status.error());
    if (signals_.stop_requested()) end.exit_status = kExitInterrupted;
    return end;
  }
  ChooseNetworkProfile();
  if (signals_.stop_requested()) return {kExitInterrupted, std::nullopt, Failure("stopped before the run began")};
  Result<RunKeys> keys = RunKeys::Make(options_.network);
  if (!keys.ok()) return FailedRun(keys.error());
  keys_ = std::move(keys).value();
  if (const Status status = service_.Start(keys_); !status.ok()) return FailedRun(status.error());
  SuperviseUntilServiceEnds();
  AwaitProcesses();
  return End();
}

int RunDistributed(const RunOptions& options, const ReportEnd& report) {
  signal(SIGPIPE, SIG_IGN);  // a connection to a host may be lost during a write
  std::optional<NewRun> again;
  int exit_status = kExitDone;
  {
    // Its end closes all connections and files before exec replaces this process.
    DistributedRun run(options);
    exit_status = run.Run(report);
    again = run.again();
  }
  return again ? StartAgain(*again) : exit_status;
}

// In scripts, which have no terminal, a run ends with its last tick.
bool StaysOpen(const RunOptions& options, const RunEnd& end) {
  const bool is_done = end.exit_status == kExitDone || end.exit_status == kExitRobotsLost;
  return !options.headless && is_done && Progress::IsInteractive();
}

void AwaitStopOfViewer(SignalWatch& signals, Progress& progress) {
  progress.Tell(kPageStaysOpen);
  pollfd waited = {signals.descriptor(), POLLIN, 0};
  while (!signals.ReadStopRequest()) poll(&waited, 1, -1);
  progress.OnStopRequest();
}

}  // namespace troupe
