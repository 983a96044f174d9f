// NetworkSettings: how the processes of a run find each other, and when they consider each other lost.
#pragma once

#include <cstdint>
#include <string>

namespace troupe {

// Values of NetworkSettings::network_interface, beside the names and IPv4 addresses of interfaces.
inline constexpr const char* kLoopbackInterface = "lo";     // this host only
inline constexpr const char* kAutomaticInterface = "auto";  // the middleware chooses one
inline constexpr std::uint32_t kMaxDomain = 230;            // the last domain whose ports are valid
// Values of NetworkSettings::security, beside folders of keys.
inline constexpr const char* kSecurityAuto = "auto";
inline constexpr const char* kSecurityOff = "off";
// Wall times. A shorter lease expires between two signs of life, and DDS counts none below a nanosecond; it has no
// longer one either.
inline constexpr double kDefaultLeaseSeconds = 2.0;
inline constexpr double kShortestLeaseSeconds = 0.01;
inline constexpr double kLongestLeaseSeconds = 3600.0;

// A participant of a world service, for the agents that it serves.
struct ServiceParticipant {
  std::uint16_t port = 0;   // UDP, for NetworkSettings::service_address
  std::string participant;  // for NetworkSettings::service_participant

  bool operator==(const ServiceParticipant&) const = default;
};

struct NetworkSettings {
  std::uint32_t domain = 42;  // DDS domain of the simulation, 0 to kMaxDomain; ROS 2 uses another one
  std::string session;        // DDS partition: runs in different sessions are isolated; without '*' and '?'
  std::string network_interface = kLoopbackInterface;  // a name, an IPv4 address, or "auto"
  std::string network_profile;  // transport/dds/binding/domain_config.h has the names; empty: chosen by the interface
  std::string service_address;  // of the world service, "host" or "host:port"; empty: this host
  // Of the world service, as 24 hexadecimal digits, for an agent: no other participant is one. Empty: the participant
  // that announces a run is the service of that run.
  std::string service_participant;
  // A folder of keys (docs/security.md), "off", or "auto": of a launcher, keys for its run alone; of any other program,
  // the keys that the user's run of this session has published, if it has any.
  std::string security = kSecurityAuto;
  // Frames and proposals between the service and agents of its machine travel through shared memory.
  bool data_sharing = true;
  double lease_seconds = kDefaultLeaseSeconds;  // a process that is silent for longer is lost
};

}  // namespace troupe
