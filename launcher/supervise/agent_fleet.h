// AgentFleet: the agent processes of a run.
//
// It decides how many processes there are, on which site each runs, in which order and when they start, and starts them
// again. It knows nothing of ticks: the supervisor tells it how many agents have joined, and asks it for restarts.
//
// Numbers: an agent's number is its place in the order of starting, and stays when it is restarted; its group is its
// place in the order of robots, which orders scans in the merged file. Neither reaches the simulation: the hash of a
// run does not depend on the packing of robots or on the order of starts.
//
// Called by the supervisor's thread alone.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/supervise/output_files.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/run_keys.h"
#include "launcher/supervise/run_options.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

// The network profile without multicast (transport/dds/binding/domain_config.h).
inline constexpr const char* kUnicastProfile = "unicast";

// One agent of the fleet. Several robots share a process when the scenario sets robots_per_process.
struct AgentProcess {
  std::size_t number;              // in the fleet; an agent that is started again keeps it
  AgentId id;                      // of the process in its run; one that is started again has another one
  std::unique_ptr<Child> process;  // the newest one
  Host* host;
  std::size_t group;  // in the order of robots
  std::vector<std::string> robots;
};

// Where agents run.
// The interface is part of the site and not of the host, because a scenario may name another one for each host.
struct AgentSite {
  Host* host;
  std::string network_interface;
};

class AgentFleet {
 public:
  // Both must outlive this.
  AgentFleet(const RunOptions& options, const RunKeys& keys);

  // `service_addresses`: by group of agents, as ready.participants. Plans an agent for every `robots_per_process`
  // consecutive robots of one site; site_of_robot[i] is the index in `sites` of the site of ready.robots[i]. Starts a
  // limited number of agents, and StartAfterJoins the others: hundreds of agents that join at the same time delay each
  // other.
  Status Start(const ReadyReport& ready, const std::vector<std::string>& service_addresses,
               const std::vector<AgentSite>& sites, const std::vector<std::size_t>& site_of_robot);

  // Starts further agents. `agents`: the number of those that have joined.
  Status StartAfterJoins(std::size_t agents);

  // Starts agents for new robots of the run, all at once. REQUIRES: Start was called.
  Status Add(const std::vector<std::string>& robots, const std::vector<std::size_t>& site_of_robot);

  // Starts the agent of this number again, for the same robots. Its scans follow its predecessor's; it writes no
  // trace. On a host that was connected again it has new keys, and a new file of scans. REQUIRES: PollEnded has
  // returned it.
  Status Restart(std::size_t number);
  // The same as a command for a shell on its host, which works as long as the host is connected.
  Result<std::string> RestartCommand(std::size_t number) const;

  // Another process continues the run as its world service, with these participants, at the same addresses: for agents
  // that are started from now on.
  void SetService(const std::vector<ServiceParticipant>& participants);

  // The ids of the agents that were started since the last call.
  std::vector<AgentId> DrainStarted() { return std::exchange(started_, {}); }
  // The numbers of the agents that ended since the last call.
  std::vector<std::size_t> PollEnded();
  const AgentProcess& agent(std::size_t number) const { return agents_.at(number); }
  std::size_t started() const { return agents_.size(); }
  std::size_t size() const { return agents_.size() + waiting_.size(); }
  bool all_ended() const { return running_ == 0; }
  void Signal(int signal) const;
  void Kill();

  // The largest resident size of an agent that has ended; 0 without one.
  double peak_memory_mib() const;
  // The host names of the robots on remote hosts, by robot.
  // Robots on this host are not in it.
  std::map<std::string, std::string> hosts() const;
  // The error about an output file of the user that a line reports which was printed on `host`; nothing for another
  // line.
  std::optional<Error> OutputFailureIn(const std::string& line, const Host& host) const;
  // A host is lost, and with it the files that its agents have written so far.
  void NoteLostFiles(const Host& host);
  // Copies the output files of agents on remote hosts into the files here. `tell` is given lines for the user while it
  // lasts; false from `goes_on` ends it with an error. Files on hosts that are lost are no error: see missing_files.
  Status FetchOutputs(const std::function<void(const std::string&)>& tell, const std::function<bool()>& goes_on);
  // What is missing in the output files because hosts were lost: "--scans of r4, r5 until host h2 was lost".
  const std::vector<std::string>& missing_files() const { return missing_files_; }
  // The agents' scan files in the order of their robots; none without --scans.
  const std::vector<std::string>& scan_files() const { return scans_.files(); }
  // The trace files of the agents; none without --trace.
  const std::vector<std::string>& trace_files() const { return traces_.files(); }

 private:
  // Why an agent is started. A robot of an agent that is started during the run may have been deleted meanwhile, so
  // that only an agent of the beginning insists on its robots; only a restarted one appends to the scans of its
  // predecessor.
  enum class Occasion : std::uint8_t {
    kAtBegin,
    kOfNewRobots,  // of an edit, while the run goes on
    kAgain,
  };
  // An agent that is still to be started.
  struct WaitingAgent {
    std::size_t group;  // in the order of robots
    std::vector<std::string> robots;
    Occasion occasion;
    double delay = 0.0;  // s
  };

  // Queues agents for the robots.
  Status Plan(const std::vector<std::string>& robots, const std::vector<std::size_t>& site_of_robot, Occasion occasion);
  // Starts waiting agents until `agents` have been started in all.
  Status StartUpTo(std::size_t agents);
  Status StartAgent(WaitingAgent agent);
  // Starts the process of a group of robots, with a new id.
  struct StartedProcess {
    AgentId id;
    std::unique_ptr<Child> process;
  };
  Result<StartedProcess> StartProcess(std::size_t group, std::vector<std::string> arguments);
  // Of the program robot-agent, without a trace.
  Result<std::vector<std::string>> ArgumentsOf(std::size_t group, const std::vector<std::string>& robots,
                                               Occasion occasion) const;

  const RunOptions& options_;
  const RunKeys& keys_;
  AgentOutput scans_;
  AgentOutput traces_;
  std::vector<AgentProcess> agents_;  // in the order of starting
  std::deque<WaitingAgent> waiting_;
  std::vector<const AgentSite*> group_sites_;  // in the order of robots
  // Constant after Start: group_sites_ points into it.
  std::vector<AgentSite> sites_;
  ReadyReport ready_;
  std::vector<std::string> service_addresses_;
  std::size_t running_ = 0;
  std::vector<AgentId> started_;  // until DrainStarted
  std::set<const Host*> lost_hosts_;
  std::vector<std::string> missing_files_;
  double peak_memory_mib_ = 0.0;  // of the processes that were replaced
};

}  // namespace troupe
