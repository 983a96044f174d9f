// Connections to all hosts of a scenario, and the address of this one.
//
// Hosts are connected at the same time, because each may need seconds for its login, and the slowest decides. Which
// robot runs on which host has no influence on the result of a run; placing is only about load.
//
// Multicast is probed before the run, because its absence has no symptom of its own: frames of the profile `lan` are
// lost in silence, and agents seem to be dead. The probe sends datagrams from the service's host to each host of
// agents, on the ports that DDS would use.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/run/run_settings.h"
#include "launcher/hosts/host.h"
#include "launcher/hosts/remote_host.h"
#include "launcher/process/process.h"
#include "troupe/result.h"

namespace troupe {

// Connects to all hosts at the same time, for the run of this session; the result has their order. The error names a
// host that cannot be reached or that lacks programs of this version. A stop request ends the wait with an error
// (signals.stop_requested() is true).
Result<std::vector<std::unique_ptr<RemoteHost>>> ConnectHosts(const std::vector<HostSettings>& hosts,
                                                              const std::string& session, std::chrono::seconds timeout,
                                                              SignalWatch& signals);

// The IPv4 address of a network interface by its name or its address; of the first one that is not a loopback interface
// for "auto". 127.0.0.1 if there is none.
std::string OwnAddress(const std::string& network_interface);

// PlaceRobots: assigns the robots of a run to its hosts.
// The index of the host of each robot: first the robots that a host names; then, in order, the number of robots that a
// host requests; the others in equal shares on the hosts that do neither. An error if a host names an unknown robot, or
// if robots are left without a host.
Result<std::vector<std::size_t>> PlaceRobots(const std::vector<std::string>& robots,
                                             const std::vector<HostSettings>& hosts);

// Whether the network passes multicast on from the host of the world service to the hosts of agents. Where it does not,
// the frames of the network profile `lan` are lost in silence.

struct MulticastProbe {
  std::string network_interface;  // a name, an IPv4 address or "auto"
  std::uint16_t port = 0;
  std::string word;  // of the datagrams
};

// In `troupe host --multicast`, on one of the hosts. Sends the word every 20 ms until the process is killed, for 10 s
// at most; or listens for it for 2 s. The exit status: 0 if it was heard, 3 if it was not, 2 if the host cannot listen.
int SendMulticast(const MulticastProbe& probe);
int ListenForMulticast(const MulticastProbe& probe);

// A host and its network interface.
using HostOnNetwork = std::pair<Host*, std::string>;

// The names of the hosts of `to` that do not hear the multicast of `from`, on the ports of a DDS domain. Ends early,
// with none, when a stop is requested (signals.stop_requested()).
std::vector<std::string> HostsWithoutMulticast(const HostOnNetwork& from, const std::vector<HostOnNetwork>& to,
                                               std::uint32_t domain, const std::string& word, SignalWatch& signals);

}  // namespace troupe
