// ConnectHosts: connections to all hosts of a scenario.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "launcher/hosts/remote_host.h"
#include "launcher/process/signal_watch.h"

namespace troupe {

// Connects to all hosts at the same time; the result has their order. The error names a host that cannot be reached or
// that lacks programs of this version. A stop request ends the wait with an error (signals.stop_requested() is true).
Result<std::vector<std::unique_ptr<RemoteHost>>> ConnectHosts(const std::vector<HostSettings>& hosts,
                                                              std::chrono::seconds timeout, SignalWatch& signals);

}  // namespace troupe
