#include <fmt/format.h>
#include <poll.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "command_line/terminal.h"
#include "launcher/process/process.h"
#include "launcher/supervise/agent_fleet.h"
#include "launcher/supervise/collect_outputs.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/restarts.h"
#include "launcher/supervise/run_again.h"
#include "launcher/supervise/run_ways.h"
#include "launcher/supervise/service_process.h"
#include "launcher/supervise/viewer_process.h"
#include "ros/link/host_program.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// A process that has not ended this long after the request to stop is killed.
constexpr auto kStopTimeout = std::chrono::seconds(10);
// The same for agents after the end of the service: they leave at once unless they hang.
constexpr auto kLeaveTimeout = std::chrono::seconds(5);

// Network profiles (transport/dds/binding/domain_config.h).
constexpr const char* kMulticastProfile = "lan";

// s, from a request to a host for a sign of life to the next one, and the number of them without an answer after which
// its agents are lost. Counted, not measured: this process may have been stopped, too.
constexpr double kPingPeriod = 1.0;
constexpr int kMaxPings = 10;

constexpr std::size_t kLongestCommand = 20'000;  // characters that are printed

// For AgentRestarts and RunHosts, which have no clock of their own so that tests can set the time.
double Seconds(Clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

// The life of a run over DDS: hosts are connected, the service is started; its "ready" report starts agents, viewer and
// the program of ROS 2; "started" is the begin of the run; a summary ends it. After that the agents leave, the outputs
// are collected, and the page may stay open.
//
// One thread, one poll (WaitForEvents): signals, ends of children, lines of hosts and times are all events of
// ProcessEvents, so that no state is shared and none is locked but the lines of the ROS program.
class DistributedRun {
 public:
  explicit DistributedRun(const RunOptions& options)
      : options_(options), hosts_(options_), service_(options_, hosts_), agents_(options_, keys_) {}

  int Run(const ReportEnd& report);
  // The run that its page has asked for at the end of Run.
  const std::optional<NewRun>& again() const { return again_; }

 private:
  RunEnd Supervise();
  // Changes to the network profile `unicast` on a network that does not pass multicast on.
  void ChooseNetworkProfile();
  void SuperviseUntilServiceEnds();
  void StartViewer();
  Status StartRosProgram(const ReadyReport& ready);
  void AwaitProcesses();
  void StopViewer();
  void AwaitStopOfViewer();
  // Waits for events, at most until kill_at_, and reacts to them.
  void ProcessEvents();
  void WaitForEvents();
  void ProcessReports();
  void React(const ReadyReport& ready);
  // Reacts to the report of a service that continues the run.
  void ReactToReturn(const ReadyReport& ready);
  void React(const NewRobotsReport& report);
  void React(const StartedReport&);
  void React(const StatusMessage& status);
  void React(const EventReport& event) { progress_.TellEvent(event.tick, event.event, event.text); }
  void React(const RunSummary& summary) { summary_ = summary; }
  void PrintOutput();
  // True for the request of the page to start the run again. Notes the address of the page, too.
  bool NotePage(const std::string& line, const Host& host);
  // False for a line that does not report the failure of an output file.
  bool NoteOutputFailure(const std::string& line, const Host& host);
  // Tells the service which agents have started and ended: only then are they lost, and silent ones are waited for.
  void TellAgents(const std::vector<std::size_t>& ended);
  // Asks the hosts for signs of life.
  void PingHosts();
  void ReactToEnd(const AgentProcess& agent);
  void ReactToLoss(Host& host, const Error& loss);
  void ReconnectHosts();
  void NoteIncompleteFiles(const AgentProcess& agent);
  void TellRestartCommand(const AgentProcess& agent, const std::string& reason);
  void RestartAgents();
  void RestartAgent(std::size_t number);
  // The service has ended: whether it is to be started again.
  bool PlanRestartOfService();
  void RestartService();
  // The service runs, or will be started again.
  bool goes_on() const { return service_.process().running() || service_restarts_.due(); }
  void CountFromTheFirstService(RunSummary& run) const;
  void Stop();
  // Ends the run. Only the first failure counts.
  void Fail(RunEnd end);
  RunEnd End();
  bool failed() const { return end_.exit_status != kExitDone && end_.exit_status != kExitInterrupted; }

  RunOptions options_;
  SignalWatch signals_;
  RunHosts hosts_;
  RunKeys keys_;
  Progress progress_;
  ServiceProcess service_;
  AgentFleet agents_;
  ViewerProcess viewer_;
  std::string page_;  // address of the page; empty: none yet
  std::optional<NewRun> again_;
  std::mutex ros_mutex_;                         // guards the lines
  std::vector<std::string> ros_lines_;           // about the program below, to be reported
  std::optional<ros::HostProgram> ros_program_;  // of this host
  AgentRestarts restarts_;                       // none before the world service is ready
  std::uint32_t restarted_ = 0;
  double next_ping_ = 0.0;                                  // s
  std::set<Host*> silent_hosts_;                            // whose agents the service has been told to have lost
  std::multimap<Host*, std::size_t> agents_of_lost_hosts_;  // to be started again once their host is connected
  ServiceRestarts service_restarts_;
  std::vector<std::uint16_t> service_ports_;    // by group of agents, once it is ready
  StatePlace newest_;                           // state, as the newest status reports it
  Edition new_robots_edition_ = 0;              // the newest that has added robots
  bool rebuilds_ = false;                       // restarts of agents are counted anew at each tick
  std::map<std::size_t, StatePlace> ended_at_;  // with rebuilds_: by agent, when it last ended
  const Clock::time_point start_ = Clock::now();
  Clock::time_point started_at_;                     // of the first world service
  Clock::time_point service_started_at_;             // of the last one
  std::optional<double> begins_at_;                  // simulated time of the first status, s
  std::optional<Clock::time_point> stop_agents_at_;  // at the end of the run
  std::optional<Clock::time_point> kill_at_;         // set by a request to stop
  std::size_t robots_ = 0;
  double startup_seconds_ = 0.0;
  bool started_ = false;
  bool error_printed_ = false;  // by a child
  std::optional<Error> output_failure_;
  std::optional<RunSummary> summary_;
  RunEnd end_;  // without the outcome
};

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

// The run goes on without its agents, as `on_agent_loss` says.
void DistributedRun::ReactToLoss(Host& host, const Error& loss) {
  agents_.NoteLostFiles(host);
  if (summary_ || kill_at_) return;
  const bool connects = started_ && &host != &hosts_.service_host() && restarts_.limit() > 0;
  if (connects) hosts_.OnLoss(host, Seconds(Clock::now()));
  progress_.Tell(loss.ToString() + (connects ? "; it is connected again once it can be reached, and its agents are "
                                               "started again"
                                             : ""));
}

void DistributedRun::ReconnectHosts() {
  if (kill_at_ || summary_ || !goes_on()) return hosts_.GiveUp();
  for (Host* host : hosts_.Reconnect(Seconds(Clock::now()))) {
    const auto [first, last] = agents_of_lost_hosts_.equal_range(host);
    progress_.Tell(fmt::format("host {}: connected again; its {} {} started again", host->name(),
                               std::distance(first, last),
                               std::distance(first, last) == 1 ? "agent is" : "agents are"));
    for (auto agent = first; agent != last; ++agent) RestartAgent(agent->second);
    agents_of_lost_hosts_.erase(host);
  }
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

// The service cannot see processes: an agent is lost only when this process says so.
void DistributedRun::TellAgents(const std::vector<std::size_t>& ended) {
  for (const AgentId agent : agents_.DrainStarted()) service_.TellStart(agent);
  for (const std::size_t number : ended) {
    const AgentProcess& agent = agents_.agent(number);
    service_.TellEnd(agent.id, agent.host->connected() ? "its process " + agent.process->end()->ToString()
                                                       : "the connection to its host is lost");
  }
}

// A silent host keeps its connection, since it may only be slow: for the service its agents are lost until it answers.
void DistributedRun::PingHosts() {
  const double now = Seconds(Clock::now());
  if (options_.hosts.empty() || now < next_ping_) return;
  next_ping_ = now + kPingPeriod;
  for (const auto& host : hosts_.all()) {
    const bool answers = host->Ping() < kMaxPings;
    if (answers != silent_hosts_.contains(host.get())) continue;
    answers ? silent_hosts_.erase(host.get()) : silent_hosts_.insert(host.get()).second;
    for (std::size_t number = 0; number < agents_.started(); ++number) {
      const AgentProcess& agent = agents_.agent(number);
      if (agent.host != host.get() || !agent.process->running()) continue;
      if (answers) {
        service_.TellStart(agent.id);
      } else {
        service_.TellEnd(agent.id,
                         fmt::format("host {} has not answered for {:.0f} s", host->name(), kMaxPings * kPingPeriod));
      }
    }
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
  progress_.Tell(fmt::format("session {}: {} robots in {} agent processes{}, ready after {:.2f} s",
                             options_.network.session, robots_, agents_.size(), on_hosts, startup_seconds_));
}

// By the agent's exit status, the phase of the run and the restarts that are left: the end of the run, a restart, or a
// robot without an agent, with a command for the user that starts it again.
void DistributedRun::ReactToEnd(const AgentProcess& agent) {
  const ProcessEnd& end = *agent.process->end();
  if (end.exit_code == kExitOutputFailed) {
    return Fail(FailedRun(output_failure_.value_or(Failure("an agent cannot write its output files"))));
  }
  if (!end.ok() && summary_ && !failed()) return NoteIncompleteFiles(agent);
  if (end.ok() || kill_at_ || summary_ || !goes_on()) return;
  const std::string& host = agent.host->name();
  if (hosts_.is_lost(*agent.host)) {
    agents_of_lost_hosts_.emplace(agent.host, agent.number);
    return;
  }
  const std::string text = fmt::format(
      "{} {}: the agent ({}process {}) {}", agent.robots.size() == 1 ? "robot" : "robots", ListText(agent.robots),
      host.empty() ? "" : "on host " + host + ", ", agent.process->pid(), end.ToString());
  // Before the start a refusal is the user's error, which the agent has printed: the run ends with its exit status.
  // Later the same status can only be a fault, and the agent's restarts decide.
  const bool refused = end.exit_code == kExitBadInput || end.exit_code == kExitFailed;
  if (started_ || !refused) {
    const auto [before, is_first] = ended_at_.try_emplace(agent.number, newest_);
    if (rebuilds_ && !is_first && std::exchange(before->second, newest_) != newest_) restarts_.Forgive(agent.number);
    if (restarts_.OnEnd(agent.number, end.exit_code, Seconds(Clock::now()))) {
      progress_.TellOneOfMany(
          fmt::format("{}; restart {} of {}", text, restarts_.CountOf(agent.number), restarts_.limit()));
    } else if (rebuilds_ && restarts_.limit() > 0) {
      // One that was refused, or whose files cannot be written, would end the same way after a restart.
      const std::uint32_t restarts = restarts_.CountOf(agent.number);
      Fail(FailedRun(Failure(restarts < restarts_.limit()
                                 ? text
                                 : fmt::format("{} after {} restarts at tick {}", text, restarts, newest_.tick))));
    } else if (!started_) {
      Fail(FailedRun(Failure(text + " before the run began")));
    } else {
      TellRestartCommand(agent, text);
    }
  } else {
    Fail({end.exit_code, std::nullopt, std::nullopt});
  }
}

// All of a run that ended in order is written, but not the last scans of an agent that died then. An agent that the run
// has lost before is in its summary.
void DistributedRun::NoteIncompleteFiles(const AgentProcess& agent) {
  const auto is_lost = [&](const std::string& robot) {
    return std::find(summary_->lost.begin(), summary_->lost.end(), robot) != summary_->lost.end();
  };
  if (agent.process->end()->exit_code == kExitInterrupted) return;  // it was stopped in order, and its file is whole
  if (options_.scans.empty() || std::all_of(agent.robots.begin(), agent.robots.end(), is_lost)) return;
  if (hosts_.is_lost(*agent.host) || output_failure_) return;
  output_failure_ = Error{{options_.scans},
                          fmt::format("the last scans of {} are missing: the agent (process {}) {}",
                                      ListText(agent.robots), agent.process->pid(), agent.process->end()->ToString()),
                          ErrorCode::kFailure};
}

void DistributedRun::TellRestartCommand(const AgentProcess& agent, const std::string& reason) {
  // The keys of an agent are gone with the connection to its host.
  const Result<std::string> command = agents_.RestartCommand(agent.number);
  if (!agent.host->connected() || !command.ok()) return progress_.TellOneOfMany(reason + "; it is not started again");
  if (command.value().size() > kLongestCommand) {
    return progress_.TellOneOfMany(
        fmt::format("{}; it is not started again (the command for its {} robots is too long to print)", reason,
                    agent.robots.size()));
  }
  const std::string there = agent.host->name().empty() ? "" : " there";
  progress_.TellOneOfMany(reason + "; to start it again" + there + ":", command.value());
}

void DistributedRun::RestartAgent(std::size_t number) {
  const Status status = agents_.Restart(number);
  if (!status.ok()) TellRestartCommand(agents_.agent(number), status.error().ToString());
}

// A restart that is due on a lost host waits for the host, without costing another restart of the limit.
void DistributedRun::RestartAgents() {
  if (kill_at_ || summary_ || !goes_on()) return restarts_.Cancel();
  for (const std::size_t number : restarts_.DrainDue(Seconds(Clock::now()))) {
    Host* const host = agents_.agent(number).host;
    if (hosts_.is_lost(*host)) {
      agents_of_lost_hosts_.emplace(host, number);
    } else {
      ++restarted_;
      RestartAgent(number);
    }
  }
}

// A service that ended in order, or refused its input or its files, would end the same way.
bool DistributedRun::PlanRestartOfService() {
  const ProcessEnd& end = *service_.process().end();
  const bool died = end.exit_code != kExitDone && end.exit_code != kExitBadInput && end.exit_code != kExitFailed &&
                    end.exit_code != kExitOutputFailed && end.exit_code != kExitInterrupted;
  if (!died || failed() || kill_at_ || summary_ || !service_.can_restart()) return false;
  const std::string& host = hosts_.service_host().name();
  const std::string text =
      fmt::format("the world service {}(process {}) {}", host.empty() ? "" : "on host " + host + " ",
                  service_.process().pid(), end.ToString());
  if (!hosts_.service_host().connected()) {
    progress_.Tell(text);
    return false;
  }
  if (service_restarts_.OnDeath(newest_, Seconds(Clock::now()))) {
    progress_.Tell(text + "; it is started again");
    return true;
  }
  progress_.Tell(text + ", time and again at the same tick");
  return false;
}

// The same ports as before: agents and viewer reconnect by the addresses that they have.
void DistributedRun::RestartService() {
  if (!service_restarts_.due() || Seconds(Clock::now()) < *service_restarts_.due()) return;
  if (kill_at_) return service_restarts_.Cancel();
  const Status started = service_.Restart(keys_, service_ports_, started_);
  service_restarts_.OnStart();
  if (!started.ok()) Fail(FailedRun(started.error()));
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

}  // namespace

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
