// Connections to all hosts of a scenario, and the address of this one.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "launcher/hosts/remote_host.h"
#include "launcher/process/signal_watch.h"

namespace troupe {

// Connects to all hosts at the same time, for the run of this session; the result has their order. The error names a
// host that cannot be reached or that lacks programs of this version. A stop request ends the wait with an error
// (signals.stop_requested() is true).
Result<std::vector<std::unique_ptr<RemoteHost>>> ConnectHosts(const std::vector<HostSettings>& hosts,
                                                              const std::string& session, std::chrono::seconds timeout,
                                                              SignalWatch& signals);

// The IPv4 address of a network interface by its name or its address; of the first one that is not a loopback interface
// for "auto". 127.0.0.1 if there is none.
std::string LocalAddress(const std::string& network_interface);

}  // namespace troupe
