// DiscoveryRelay: bounds discovery on the loopback interface, where every participant hears every other: a hundred
// agents would discover each other, and that takes longer than all else at the start. So agents announce themselves to
// the relay only, and the relay forwards the announcements of all others on this machine to each agent, which answers
// them.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <thread>
#include <vector>

#include "common/base/wake_event.h"

namespace troupe::ros {

class DiscoveryRelay {
 public:
  // Agents, and likewise other participants, that are known at a time: a hostile program can make up any number.
  static constexpr std::size_t kMost = 1000;

  // `indices`: at the ports of how many participant indices tools without multicast announce themselves. Throws
  // dds::Exception without sockets.
  DiscoveryRelay(std::uint32_t domain, std::uint32_t indices);
  ~DiscoveryRelay();
  DiscoveryRelay(const DiscoveryRelay&) = delete;
  DiscoveryRelay& operator=(const DiscoveryRelay&) = delete;

  // UDP, on the loopback interface: the only peer of agents.
  std::uint16_t port() const { return port_; }

 private:
  using Clock = std::chrono::steady_clock;
  using Prefix = std::array<std::uint8_t, 12>;
  using Datagram = std::vector<std::uint8_t>;
  class Socket;
  struct Agent {
    std::uint16_t port = 0;
    Clock::time_point seen;
  };
  struct Other {
    Datagram announcement;
    Clock::time_point seen;
  };

  void Run();
  void OnAgent(const Datagram& datagram);
  void OnOther(const Datagram& datagram);
  void Send(const Datagram& datagram, std::uint16_t port) const;
  void ForgetSilent();

  std::vector<Socket> sockets_;  // first that of agents, then those of others
  const WakeEvent stop_;
  std::uint16_t port_ = 0;
  std::map<Prefix, Agent> agents_;
  std::map<Prefix, Other> others_;
  std::thread thread_;  // last, because it uses all other members
};

}  // namespace troupe::ros
