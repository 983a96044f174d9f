#include "transport/dds/binding/domain_config.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "common/base/file.h"
#include "common/base/hash.h"
#include "common/base/paths.h"
#include "troupe/check.h"

namespace troupe::dds {
namespace {

// As text inside a quoted attribute. Cyclone expands ${...} in values, which a name from the command line never means.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '$') {
      escaped += "\\$";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

bool IsAddress(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

// An element. `more`: attributes.
std::string Interface(const std::string& name, const std::string& more) {
  const std::string attribute = name == "auto"    ? R"(autodetermine="true")"
                                : IsAddress(name) ? "address=\"" + Escaped(name) + "\""
                                                  : "name=\"" + Escaped(name) + "\"";
  return "<NetworkInterface " + attribute + more + "/>";
}

std::string Interfaces(const DomainConfig& config, const std::string& profile) {
  const std::string more = profile == "one-host" ? R"( multicast="true")" : "";
  return Interface(config.network_interface, more) + (config.adds_loopback ? Interface("lo", more) : "");
}

std::string ParticipantIndex(const DomainConfig& config) {
  if (config.participant_index) return std::to_string(*config.participant_index);
  return config.indices_tried > 0 ? "auto" : "none";
}

std::uint32_t LastIndexTried(const DomainConfig& config) {
  // Cyclone takes no index as high as the last one.
  return config.indices_tried > 0 ? config.indices_tried : kPeerPortsTried - 1;
}

std::string Multicast(const DomainConfig& config) {
  if (config.data_multicast) return config.discovery_multicast ? "spdp,asm" : "asm";
  return config.discovery_multicast ? "spdp" : "false";
}

// The time from one announcement to the next, in leases. Cyclone's own, 0.8, loses idle participants on a machine that
// delays one announcement by a fifth of the lease, and with DDS Security two participants of which only one has lost
// the other find each other again after more than a minute.
constexpr double kAnnouncementPeriod = 0.4;

std::string Peers(const DomainConfig& config) {
  std::string peers;
  for (const std::string& peer : config.peers) peers += R"(<Peer address=")" + Escaped(peer) + R"("/>)";
  return peers;
}

constexpr std::size_t kMaxCertificate = 100'000;  // bytes

bool IsFree(std::uint16_t port) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return true;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool free = bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(socket);
  return free;
}

}  // namespace

DomainConfig ToolConfig(std::uint32_t domain, const std::string& network_interface,
                        const std::string& service_address) {
  DomainConfig config;
  config.domain = domain;
  config.network_interface = network_interface;
  config.peers = {service_address.empty() ? "127.0.0.1" : service_address};
  config.heartbeat_seconds = 0.1;  // a tool ends when its requests are acknowledged
  return config;
}

void SetKeys(DomainConfig& config, const std::string& enclave) {
  config.security_enclave = enclave;
  if (enclave.empty()) return;
  const Result<std::string> authority = ReadWholeFile(enclave + "/" + kIdentityCaFile, kMaxCertificate);
  if (!authority.ok()) return;  // the participant cannot be made, and says why
  Hasher hash;
  hash.Add(std::string_view(authority.value()));
  config.tag = "troupe_keys_" + std::to_string(hash.value());
}

std::uint16_t DiscoveryPort(std::uint32_t domain, std::uint32_t participant_index) {
  return static_cast<std::uint16_t>(7400 + 250 * domain + 10 + 2 * participant_index);
}

std::string NetworkProfile(const DomainConfig& config) {
  if (!config.network.empty()) return config.network;
  return config.network_interface == "lo" || config.network_interface.starts_with("127.") ? "one-host" : "lan";
}

std::string ToXml(const DomainConfig& config) {
  const std::string profile = NetworkProfile(config);
  const std::map<std::string_view, std::string> words = {
      {"INTERFACES", Interfaces(config, profile)},
      {"MULTICAST", Multicast(config)},
      {"DOMAIN", std::to_string(config.domain)},
      {"TAG", Escaped(config.tag)},
      {"PARTICIPANT_INDEX", ParticipantIndex(config)},
      {"LAST_INDEX_TRIED", std::to_string(LastIndexTried(config))},
      {"PEERS", Peers(config)},
      {"MAX_SAMPLE", std::to_string(config.max_sample_bytes) + "B"},
      {"KEY_HASHES", config.key_hashes ? "true" : "false"},
      {"ANNOUNCE", std::to_string(std::min(config.announce_seconds, kAnnouncementPeriod * config.lease_seconds)) + "s"},
      {"LINGER", std::to_string(config.linger_seconds) + "s"},
      {"HEARTBEAT", std::to_string(config.heartbeat_seconds) + "s"},
      {"LEASE", std::to_string(config.lease_seconds) + "s"},
  };
  std::string_view rest = profile == "one-host" ? kOneHostProfile : profile == "lan" ? kLanProfile : kUnicastProfile;
  std::string xml;
  for (std::size_t mark; (mark = rest.find('@')) != std::string_view::npos;) {
    const std::size_t end = rest.find('@', mark + 1);
    TROUPE_CHECK(end != std::string_view::npos);
    xml += rest.substr(0, mark);
    xml += words.at(rest.substr(mark + 1, end - mark - 1));
    rest.remove_prefix(end + 1);
  }
  return xml.append(rest);
}

bool PortsAreFree(std::uint32_t domain, std::uint32_t participant_index) {
  const std::uint16_t port = DiscoveryPort(domain, participant_index);
  return IsFree(port) && IsFree(static_cast<std::uint16_t>(port + 1));
}

}  // namespace troupe::dds
