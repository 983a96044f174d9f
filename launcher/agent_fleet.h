// AgentFleet: the agent processes of a run.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"
#include "launcher/process.h"
#include "launcher/run_options.h"
#include "launcher/scan_parts.h"
#include "launcher/service_report.h"

namespace troupe {

struct AgentProcess {
  Process process;
  std::vector<std::string> robots;
  std::string restart_command;  // for a person's shell
};

class AgentFleet {
 public:
  // The options must outlive this.
  AgentFleet(const RunOptions& options, std::string program);

  // Starts an agent for every `robots_per_process` robots. Children write what they say to `output`.
  Status Start(const ReadyReport& ready, int output);

  // The agents that ended since the last call.
  std::vector<const AgentProcess*> TakeEnded();
  std::size_t size() const { return agents_.size(); }
  bool all_ended() const { return running_ == 0; }
  void Signal(int signal) const;
  void Kill();

  // Of the largest agent.
  double peak_memory_mib() const;
  // The agents' scan files in the order of their robots; none without --scans.
  const std::vector<std::string>& scan_files() const { return scan_files_; }

 private:
  const RunOptions& options_;
  std::string program_;
  ScanParts scan_parts_;
  std::vector<std::string> scan_files_;
  std::vector<AgentProcess> agents_;  // in the order of starting
  std::size_t running_ = 0;
};

}  // namespace troupe
