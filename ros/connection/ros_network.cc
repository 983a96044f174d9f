#include "ros/connection/ros_network.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <unistd.h>

#include "transport/dds/binding/entity.h"
#include "troupe/check.h"

namespace troupe::ros {
namespace {

constexpr const char* kLoopback = "lo";
constexpr double kLocalAnnouncement = 1.0;  // s

bool IsLoopback(const std::string& network_interface) {
  return network_interface == kLoopback || network_interface.starts_with("127.");
}

bool HasOtherInterface() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return false;
  bool found = false;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    found = found || ((entry->ifa_flags & IFF_UP) != 0 && (entry->ifa_flags & IFF_LOOPBACK) == 0);
  }
  freeifaddrs(first);
  return found;
}

// IPv4, as text. Once for all ports, because a name service can be slow.
std::string AddressOf(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int failure = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (failure != 0) {
    throw dds::Exception(DDS_RETCODE_BAD_PARAMETER, "starting ROS: found no address of the static peer '" + host +
                                                        "' (" + gai_strerror(failure) + ")");
  }
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr, text, sizeof text);
  freeaddrinfo(found);
  return text;
}

void AddPeer(dds::DomainConfig& config, const std::string& address, std::uint32_t indices) {
  for (std::uint32_t index = 0; index < indices; ++index) {
    config.peers.push_back(address + ":" + std::to_string(dds::DiscoveryPort(config.domain, index)));
  }
}

// Tools may have no multicast here: they announce themselves at the ports of the first indices. A process without an
// index answers none of that, so it announces itself often.
void DiscoverOnThisMachine(dds::DomainConfig& config, const RosNetwork& network) {
  AddPeer(config, "127.0.0.1", IndicesSearched(network.distribution));
  config.announce_seconds = kLocalAnnouncement;
}

using dds::Durability;
using dds::DurabilityService;
using dds::History;
using dds::Lifespan;
using dds::Qos;
using dds::Reliability;
using dds::WriterDataLifecycle;

// s. A write must not delay a tick. Nor may it be the default of 100 ms: Cyclone omits a default from its
// announcements, and some other implementations then do not match.
constexpr double kMaxBlockingTime = 0.001;
constexpr double kLineSeconds = 10.0;

Qos KeptForLateReaders(std::int32_t depth) {
  return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::TransientLocal() << History::KeepLast(depth)
               << DurabilityService{History::KeepLast(depth)} << WriterDataLifecycle{false};
}

}  // namespace

std::uint32_t IndicesSearched(Distribution distribution) {
  return distribution == Distribution::kHumble ? 10 : 33;
}

bool AnnouncesOnLoopback(const RosNetwork& network) {
  return network.discovery == DiscoveryRange::kLocalhost ||
         (network.discovery != DiscoveryRange::kOff && IsLoopback(network.network_interface));
}

bool UsesLoopbackOnly(const RosNetwork& network) {
  return IsLoopback(network.network_interface) ||
         (network.discovery == DiscoveryRange::kLocalhost && network.distribution == Distribution::kHumble);
}

dds::DomainConfig NetworkConfig(const RosNetwork& network) {
  dds::DomainConfig config;
  config.domain = network.domain;
  config.network_interface = network.network_interface;
  config.data_multicast = false;  // as ROS by default: not every network has multicast
  config.key_hashes = true;
  config.heartbeat_seconds = 0.1;  // only a heartbeat reveals the loss of a last message, or that a writer may end
  const bool is_humble = network.distribution == Distribution::kHumble;
  const std::uint32_t indices = IndicesSearched(network.distribution);
  switch (network.discovery) {
    case DiscoveryRange::kOff:
      config.network = "unicast";
      config.discovery_multicast = false;
      config.tag = "ros_discovery_off_" + std::to_string(getpid());
      return config;
    case DiscoveryRange::kSystemDefault:
      break;
    case DiscoveryRange::kLocalhost:
      config.network = "one-host";
      if (config.network_interface == "auto" && (is_humble || !HasOtherInterface())) {
        config.network_interface = kLoopback;
      }
      // From Iron on, tools use their usual interface here, so that localhost is a peer and not an interface.
      config.adds_loopback = !IsLoopback(config.network_interface);
      DiscoverOnThisMachine(config, network);
      break;
    case DiscoveryRange::kSubnet:
      if (IsLoopback(config.network_interface)) DiscoverOnThisMachine(config, network);
      break;
  }
  if (network.discovery != DiscoveryRange::kSystemDefault) {
    for (const std::string& peer : network.static_peers) AddPeer(config, AddressOf(peer), indices);
    // Half of them, so that tools find free ones too. With multicast, Humble's tools need none.
    if (!is_humble || !config.peers.empty()) config.indices_tried = indices / 2;
  }
  return config;
}

Qos ToDds(const TopicQos& qos) {
  switch (qos.kind) {
    case TopicQos::Kind::kStream:
      return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::Volatile() << History::KeepLast(qos.depth)
                   << WriterDataLifecycle{false};
    case TopicQos::Kind::kLatched:
      return KeptForLateReaders(qos.depth);
    case TopicQos::Kind::kReliableCommands:
      return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::Volatile() << History::KeepLast(qos.depth);
    case TopicQos::Kind::kBestEffortCommands:
      return Qos() << Reliability::BestEffort() << Durability::Volatile() << History::KeepLast(qos.depth);
    case TopicQos::Kind::kLogLines:
      return KeptForLateReaders(qos.depth) << Lifespan{kLineSeconds};
  }
  TROUPE_CHECK(false);
}

TopicQos Stream(std::int32_t depth) {
  return {TopicQos::Kind::kStream, depth};
}

TopicQos Latched(std::int32_t depth) {
  return {TopicQos::Kind::kLatched, depth};
}

TopicQos Commands(bool reliable, std::int32_t depth) {
  return {reliable ? TopicQos::Kind::kReliableCommands : TopicQos::Kind::kBestEffortCommands, depth};
}

TopicQos Service(std::int32_t depth) {
  return Stream(depth);
}

TopicQos LogLines() {
  constexpr std::int32_t kLines = 1000;
  return {TopicQos::Kind::kLogLines, kLines};
}

}  // namespace troupe::ros
