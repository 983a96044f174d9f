#include "ros/fast_dds/fast_network.h"

#include <arpa/inet.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <ifaddrs.h>
#include <netdb.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "ros/connection/ros_network.h"
#include "ros/fast_dds/apart_transport.h"

namespace troupe::ros {
namespace {

using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

constexpr const char* kLoopbackAddress = "127.0.0.1";
constexpr const char* kDiscoveryGroup = "239.255.0.1";
// s. The services of a process that was killed disappear for others after its lease.
constexpr std::int32_t kLease = 10;
constexpr std::int32_t kAnnouncementPeriod = 1;

bool IsAddress(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

std::string AddressOfInterface(const std::string& name) {
  if (IsAddress(name)) return name;
  std::string address;
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) == 0) {
    for (const ifaddrs* entry = first; entry != nullptr && address.empty(); entry = entry->ifa_next) {
      if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET || name != entry->ifa_name) continue;
      char text[INET_ADDRSTRLEN] = "";
      inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr, text, sizeof text);
      address = text;
    }
    freeifaddrs(first);
  }
  if (address.empty()) throw std::runtime_error("the network interface '" + name + "' has no IPv4 address");
  return address;
}

std::string AddressOfHost(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) {
    throw std::runtime_error("found no address of the static peer '" + host + "'");
  }
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr, text, sizeof text);
  freeaddrinfo(found);
  return text;
}

// Fast DDS fills in the ports: of multicast, or of the first participant indices.
void AddPeer(DomainParticipantQos& qos, const std::string& address) {
  Locator_t locator;
  IPLocator::setIPv4(locator, address);
  qos.wire_protocol().builtin.initialPeersList.push_back(locator);
}

}  // namespace

DomainParticipantQos FastNetwork(const RosNetwork& network) {
  // Without shared memory, whose layout in the programs of a ROS distribution can be that of another version.
  auto transport = std::make_shared<UDPv4TransportDescriptor>();
  transport->maxInitialPeersRange = IndicesSearched(network.distribution);
  if (network.discovery == DiscoveryRange::kLocalhost) transport->TTL = 0;  // multicast stays on this machine
  const bool local = AnnouncesOnLoopback(network);
  if (UsesLoopbackOnly(network)) {
    transport->interfaceWhiteList = {kLoopbackAddress};
  } else if (network.network_interface != "auto") {
    transport->interfaceWhiteList = {AddressOfInterface(network.network_interface)};
    if (local) transport->interfaceWhiteList.emplace_back(kLoopbackAddress);
  }
  DomainParticipantQos qos;
  qos.name("ros_participant");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(ApartFromCyclone(transport));
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = {kLease, 0};
  discovery.leaseDuration_announcementperiod = {kAnnouncementPeriod, 0};
  AddPeer(qos, kDiscoveryGroup);
  if (local) AddPeer(qos, kLoopbackAddress);
  if (network.discovery != DiscoveryRange::kSystemDefault) {
    for (const std::string& peer : network.static_peers) AddPeer(qos, AddressOfHost(peer));
  }
  // As a participant of ROS; its endpoints belong to no node.
  const std::string enclave = "enclave=/;";
  qos.user_data().setValue({enclave.begin(), enclave.end()});
  return qos;
}

}  // namespace troupe::ros
