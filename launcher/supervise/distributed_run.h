// DistributedRun: the launcher's part of a run over DDS (RunDistributed in run_ways.h). distributed_run.cc has the life
// of the run from its start to its end, run_losses.cc the deaths of processes, lost hosts, and restarts.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "launcher/process/process.h"
#include "launcher/supervise/agent_fleet.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/restarts.h"
#include "launcher/supervise/run_again.h"
#include "launcher/supervise/run_ways.h"
#include "launcher/supervise/service_process.h"
#include "launcher/supervise/viewer_process.h"
#include "ros/link/host_program.h"

namespace troupe {

// Wall time in s, for AgentRestarts and RunHosts, which have no clock of their own so that tests can set the time.
inline double Seconds(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

// The life of a run over DDS: hosts are connected, the service is started; its "ready" report starts agents, viewer and
// the program of ROS 2; "started" reports the first tick of the run, and a summary its end. After that the agents
// leave, the outputs are collected, and the page may stay open.
//
// One thread, one poll (WaitForEvents): signals, ends of children, lines of hosts and times are all events of
// ProcessEvents, so that no state is shared and none is locked but the lines of the ROS program.
class DistributedRun {
 public:
  using Clock = std::chrono::steady_clock;

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

}  // namespace troupe
