// RunHosts: the hosts of a run: the launcher's, and the remote hosts of its scenario.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/process/signal_watch.h"
#include "launcher/supervise/agent_fleet.h"
#include "launcher/supervise/run_options.h"
#include "troupe/result.h"

namespace troupe {

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

  // Where agents run.
  std::vector<AgentSite> AgentSites() const;
  // The index of the site of each robot.
  Result<std::vector<std::size_t>> PlaceOnSites(const std::vector<std::string>& robots) const;

 private:
  struct Attempt {
    double since = 0.0;
    bool has_failed = false;
  };

  static double NextAttempt(const Attempt& attempt);

  const RunOptions& options_;
  std::vector<std::unique_ptr<Host>> hosts_;
  std::map<Host*, Attempt> lost_;  // the newest attempt
};

}  // namespace troupe
