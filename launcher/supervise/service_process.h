// ServiceProcess: the world service of a run, as a process on its host.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/supervise/output_files.h"
#include "launcher/supervise/run_hosts.h"
#include "launcher/supervise/run_keys.h"
#include "launcher/supervise/run_options.h"
#include "troupe/result.h"

namespace troupe {

class ServiceProcess {
 public:
  // The options and the hosts must outlive this.
  ServiceProcess(const RunOptions& options, const RunHosts& hosts);

  Status Start(const RunKeys& keys);
  // Starts the process again, which has ended, to continue the run at the same port. `begun`: the run, not only its
  // process. REQUIRES: can_restart()
  Status Restart(const RunKeys& keys, const std::vector<std::uint16_t>& ports, bool begun);
  // The run has a journal.
  bool can_restart() const { return !journal_.empty(); }

  // REQUIRES, for all below: Start has succeeded.
  Child& process() const { return *process_; }
  // As AgentFleet::OutputFailureIn, for the files of the service.
  std::optional<Error> OutputFailureIn(const std::string& line) const;
  // Copies the service's output files from a remote host to the paths of the options.
  Status FetchOutputs(const FetchProgress& progress) const;
  // The trace of the service on this host; empty: none.
  const std::string& trace_file() const { return trace_file_; }

 private:
  // The options with the paths and the network interface of the service's host.
  RunOptions OptionsThere() const;
  // The paths of its output files there, with those of the user.
  std::vector<std::pair<std::string, std::string>> Outputs() const;

  const RunOptions& options_;
  const RunHosts& hosts_;
  Status MakeJournal();
  Status StartProcess(const RunKeys& keys, const std::vector<std::string>& more);

  OutputParts journal_parts_;
  std::vector<std::string> journal_;  // arguments; empty: none
  OutputParts trace_parts_;
  std::string trace_file_;
  bool has_begun_ = false;
  std::unique_ptr<Child> process_;
};

}  // namespace troupe
