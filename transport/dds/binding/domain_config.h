// DomainConfig: how a participant discovers others and moves data; becomes Cyclone's XML. The files in configs/cyclone,
// one for each profile, give the reasons.
//
// Each participant has a configuration of its own, so that an agent, a viewer and ROS 2 can be in one process or one
// domain with different discovery. The files are templates: ToXml fills in words between at signs, escaped, because
// names of interfaces and addresses come from a command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace troupe::dds {

struct DomainConfig {
  std::uint32_t domain = 0;              // 0..230
  std::string network_interface = "lo";  // a name or an IPv4 address; "auto": Cyclone's choice
  bool adds_loopback = false;            // the loopback interface beside another one
  std::string network;                   // a profile: "one-host", "lan", "unicast"; empty: by the interface
  // A number fixes the ports, so that others can name this participant as a peer; without one it uses any free port.
  std::optional<std::uint32_t> participant_index;
  // Without a number: takes the first free one below this. Without a free one it uses any free port.
  std::uint32_t indices_tried = 0;
  bool data_multicast = true;                   // to many readers at once
  bool discovery_multicast = true;              // announces itself by multicast; otherwise to the peers only
  std::vector<std::string> peers;               // "host" or "host:port" of discovery; a host alone: its first ports
  std::uint32_t max_sample_bytes = 0x7fffffff;  // longer samples are dropped before they are put together
  // Participants on Fast DDS learn of the ends of this one and of its endpoints at once, not by the lease.
  bool key_hashes = false;
  double lease_seconds = 10.0;     // others forget a participant that is silent for longer
  double announce_seconds = 30.0;  // from one announcement to the next, at most; or 0.4 of the lease
  // Announces its types' structure (XTypes). Without, endpoints match by the names of types, and a participant starts
  // sooner and needs less memory; its own types cannot be found by tools that ask it for their structure.
  bool describes_types = true;
  // The time from one announcement of unacknowledged samples to the next, in the profile one-host.
  double heartbeat_seconds = 1.0;
  // For which a writer that ends waits until its samples are acknowledged. Readers that were killed do not acknowledge,
  // and one writer waits after the other; with 0 their owner waits for all: Publisher::AwaitAcknowledgments.
  double linger_seconds = 1.0;
  std::string tag;  // only participants with the same one discover each other
  // The process knows the domain by its number on the network. Needed where permissions name domains, because Cyclone
  // compares them with the number in the process. All such participants of one domain need equal configurations.
  bool numbered_as_on_network = false;
  std::string security_enclave;  // the folder with the participant's keys (common/base/paths.h); empty: no security
};

// The configuration of a tool that looks for world services. An empty address: the services of this machine.
DomainConfig ToolConfig(std::uint32_t domain, const std::string& network_interface, const std::string& service_address);

// Sets the keys: the folder with them, or empty for none. Their tag is a hash of the authority's certificate, so that
// participants with keys of other authorities, as of other runs, are not discovered: each handshake with one would end
// with a warning on both sides.
void SetKeys(DomainConfig& config, const std::string& enclave);

// The UDP port at which a participant with this index listens for discovery (RTPS 2.2, section 9.6.1).
std::uint16_t DiscoveryPort(std::uint32_t domain, std::uint32_t participant_index);

// Peers without a port are looked for at the discovery ports of this many participant indices.
inline constexpr std::uint32_t kPeerPortsTried = 10;

// The profile that `config` asks for, or that suits its interface: "one-host" on the loopback interface, else "lan".
std::string NetworkProfile(const DomainConfig& config);

std::string ToXml(const DomainConfig& config);

// Cyclone's configurations (configs/cyclone, compiled in), with words between at signs for ToXml to fill in.

extern const char* const kOneHostProfile;
extern const char* const kLanProfile;
extern const char* const kUnicastProfile;

// Whether a participant could have an index on this machine: Cyclone binds its ports, and does not tell which ones are
// in use. The discovery port of a participant with this index, and the one after it, for data, are free now. True as
// well if no socket can be made: DDS reports the cause.
bool PortsAreFree(std::uint32_t domain, std::uint32_t participant_index);

}  // namespace troupe::dds
