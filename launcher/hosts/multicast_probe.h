// Whether the network passes multicast on from the host of the world service to the hosts of agents. Where it does not,
// the frames of the network profile `lan` are lost in silence.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/process/signal_watch.h"

namespace troupe {

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
