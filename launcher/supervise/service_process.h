// ServiceProcess: the world service of a run, as a process on its host. RunHosts: the hosts of the run.
//
// A service that dies is started again with --resume and continues from the journal, at the same ports, so that agents
// find it by the addresses that they have. If the user has named no journal, it is in files without names, which need
// no cleaning up whatever happens; such a journal is optional: a full disk costs the ability to continue, not the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/process/process.h"
#include "launcher/supervise/agent_fleet.h"
#include "launcher/supervise/output_files.h"
#include "launcher/supervise/run_keys.h"
#include "launcher/supervise/run_options.h"
#include "troupe/result.h"

namespace troupe {

// RunHosts: the hosts of a run: the launcher's, and the remote hosts of its scenario.
class RunHosts {
 public:
  // The options must outlive this.
  explicit RunHosts(const RunOptions& options);

  // Connects to the remote hosts. A stop request ends the wait with an error (signals.stop_requested() is true).
  Status Connect(SignalWatch& signals);

  // This host, and then the remote hosts.
  const std::vector<std::unique_ptr<Host>>& all() const { return hosts_; }
  // Readable when a host has news.
  std::vector<int> descriptors() const;

  // A host is lost: it is connected again from now on. Times are in s, of any clock that does not decrease.
  void OnLoss(Host& host, double now);
  bool is_lost(Host& host) const { return lost_.contains(&host); }
  // Begins attempts to connect again that are due; returns the hosts that are connected again, each once.
  std::vector<Host*> Reconnect(double now);
  // No further attempts.
  void GiveUp() { lost_.clear(); }
  // When to call it again; nothing: no host is lost.
  std::optional<double> NextReconnect() const;

  // The host of the world service.
  Host& service_host() const;
  // Its settings; null: this host.
  const HostSettings* service_settings() const;
  // "host:port", by which agents find a service that listens at this port.
  std::string ServiceAddress(std::uint16_t port) const;

  // The names of the hosts of agents that do not hear the multicast of the world service's host; none where all is on
  // the loopback interface, and when a stop is requested meanwhile (signals.stop_requested()).
  std::vector<std::string> WithoutMulticast(SignalWatch& signals) const;

  // Where agents run.
  std::vector<AgentSite> AgentSites() const;
  // The index of the site of each robot.
  Result<std::vector<std::size_t>> PlaceOnSites(const std::vector<std::string>& robots) const;

 private:
  // An attempt to connect a lost host again. The next one follows a failure after kReconnectPeriod, and silence after
  // the longer kReconnectTimeout.
  struct Attempt {
    double since = 0.0;
    bool has_failed = false;
  };

  static double NextAttempt(const Attempt& attempt);

  const RunOptions& options_;
  std::vector<std::unique_ptr<Host>> hosts_;
  std::map<Host*, Attempt> lost_;  // the newest attempt
};

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

  // The options with which another process on the launcher's host reads the journal; empty: it cannot.
  std::vector<std::string> JournalOptions() const;

  // REQUIRES, for all below: Start has succeeded.
  Child& process() const { return *process_; }
  // Tells the service that an agent was started, and how one has ended.
  void TellStart(AgentId agent) const;
  void TellEnd(AgentId agent, const std::string& end) const;
  // As AgentFleet::OutputFailureIn, for the files of the service.
  std::optional<Error> OutputFailureIn(const std::string& line) const;
  // Copies the service's output files from a remote host to the paths of the options.
  Status FetchOutputs(const FetchProgress& progress) const;
  // The trace of the service on this host; empty: none.
  const std::string& trace_file() const { return trace_file_; }

 private:
  // The options with the paths and the network interface of the service's host.
  RunOptions OptionsOnHost() const;
  // The paths of its output files there, with the user's paths.
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
  std::uint32_t successors_ = 0;  // services that were started again
  std::unique_ptr<Child> process_;
};

}  // namespace troupe
