// HostParticipants: the programs ros-participant of a run with ROS 2, one on each host with agents.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "launcher/supervise/agent_fleet.h"
#include "launcher/supervise/run_options.h"
#include "launcher/supervise/supervised_process.h"

namespace troupe {

class HostParticipants {
 public:
  // Starts them, and tells the sites their sockets; the agents of a site without one have participants of their own.
  // The hosts must outlive this. The error, the first one, is for people.
  Status Start(std::vector<AgentSite>& sites, const RunOptions& options);

  // As those of SupervisedProcess, of all.
  std::vector<std::string> Poll(double now);
  std::optional<double> NextDue() const;
  bool running() const;
  void Stop();
  void Kill();

 private:
  std::deque<SupervisedProcess> processes_;
};

}  // namespace troupe
