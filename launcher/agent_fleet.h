// AgentFleet: the agent processes of a run.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "launcher/machine.h"
#include "launcher/output_parts.h"
#include "launcher/run_options.h"
#include "launcher/service_report.h"

namespace troupe {

struct AgentProcess {
  std::unique_ptr<Child> process;
  const Machine* machine;
  std::vector<std::string> robots;
  std::string restart_command;  // for a person's shell
};

// Where agents run.
struct AgentSite {
  Machine* machine;
  std::string network_interface;
};

class AgentFleet {
 public:
  // The options must outlive this.
  explicit AgentFleet(const RunOptions& options);

  // Starts an agent for every `robots_per_process` robots that are neighbours and on one site; site_of_robot[i] is the
  // index of that of ready.robots[i]. The first ones at once, and others when some have joined: hundreds that meet the
  // service together hold each other up.
  Status Start(const ReadyReport& ready, const std::string& service_address, const std::vector<AgentSite>& sites,
               const std::vector<std::size_t>& site_of_robot);

  // So many agents have joined.
  Status TakeJoined(std::size_t agents);

  // Starts agents for further robots of the run, all at once. REQUIRES: Start was called.
  Status Add(const std::vector<std::string>& robots, const std::vector<std::size_t>& site_of_robot);

  // The agents that ended since the last call.
  std::vector<const AgentProcess*> TakeEnded();
  std::size_t size() const { return agents_.size() + waiting_.size(); }
  bool all_ended() const { return running_ == 0; }
  void Signal(int signal) const;
  void Kill();

  // Of the largest agent.
  double peak_memory_mib() const;
  // The name of each robot's host; nothing for those on this machine.
  std::map<std::string, std::string> hosts() const;
  // Copies what agents on other machines wrote into the files here.
  Status FetchOutputs();
  // The agents' scan files in the order of their robots; none without --scans.
  const std::vector<std::string>& scan_files() const { return scans_.files; }
  // The same with --trace.
  const std::vector<std::string>& trace_files() const { return traces_.files; }

 private:
  // One kind of output, of which each agent writes a part.
  struct Output {
    std::string option;
    OutputParts parts;
    std::vector<std::string> files;  // here, by group; none if it is not asked for

    Output(const std::string& name, const std::string& output) : option(name), parts(output, name) {}
    Status AddFiles(std::size_t count);
    // Where the agent writes it.
    std::string FileOn(const Machine& machine, std::size_t group) const;
  };

  // An agent that is to be started.
  struct WaitingAgent {
    std::size_t group;  // in the order of robots
    std::vector<std::string> robots;
    double delay = 0.0;  // s
  };

  // Queues agents for the robots.
  Status Plan(const std::vector<std::string>& robots, const std::vector<std::size_t>& site_of_robot);
  // Starts waiting ones until there are so many.
  Status StartUpTo(std::size_t agents);
  Status StartAgent(WaitingAgent agent);

  const RunOptions& options_;
  Output scans_;
  Output traces_;
  std::vector<AgentProcess> agents_;  // in the order of starting
  std::deque<WaitingAgent> waiting_;
  std::vector<const AgentSite*> group_sites_;  // in the order of robots
  std::vector<AgentSite> sites_;
  ReadyReport ready_;
  std::string service_address_;
  std::size_t running_ = 0;
};

}  // namespace troupe
