// RunHosts: the hosts of a run: the launcher's, and the remote hosts of its scenario.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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
  const RunOptions& options_;
  std::vector<std::unique_ptr<Host>> hosts_;
};

}  // namespace troupe
