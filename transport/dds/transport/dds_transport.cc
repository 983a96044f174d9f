#include "transport/dds/transport/dds_transport.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

#include "transport/dds/binding/domain_config.h"
#include "transport/dds/transport/dds_agent_endpoint.h"
#include "transport/dds/transport/dds_observer_endpoint.h"
#include "transport/dds/transport/dds_service_endpoint.h"
#include "transport/protocol/message_texts.h"
#include "troupe/check.h"

namespace troupe {
namespace {

using dds::DdsConnection;
using dds::DomainConfig;

// Bounds the memory that a stranger's messages need. The longest that a service receives is the join or the proposal of
// an agent with a hundred thousand robots.
constexpr std::uint32_t kMaxSampleForService = 16'000'000;  // bytes
// The largest sample for agents and observers is a world.
constexpr std::uint32_t kMaxSampleForPeers = 1'000'000'000;

constexpr double kHeartbeatWithSharing = 0.1;  // s

constexpr std::uint32_t kParticipantsOfMachine = 100;  // of services that share a domain: their participant indices

std::optional<dds::GuidPrefix> ServiceOf(const DdsOptions& options) {
  if (options.service_participant.empty()) return std::nullopt;
  const std::optional<dds::GuidPrefix> prefix = dds::ParseGuidPrefix(options.service_participant);
  if (prefix) return prefix;
  throw dds::Exception(DDS_RETCODE_BAD_PARAMETER, "looking for the participant '" + options.service_participant +
                                                      "' (expected 24 hexadecimal digits)");
}

// The participants for the endpoints of one role: their discovery settings suit no other one.
class DdsTransport : public Transport {
 public:
  enum class Role { kService, kAgent, kObserver };

  DdsTransport(Role role, const DdsOptions& options, const DomainConfig& config)
      : role_(role), service_(ServiceOf(options)), data_sharing_(options.data_sharing) {
    Add(options, config);
  }

  // Adds a participant for another group of agents. REQUIRES: there is no endpoint yet.
  void Add(const DdsOptions& options, const DomainConfig& config) {
    connections_.push_back(std::make_unique<DdsConnection>(config, options.session, options.on_problem,
                                                           options.keys.token, AgentOf(role_, options)));
    connections_.back()->on_foreign_run = options.on_foreign_run;
  }

  // The GUID of the participant that was added last.
  std::string participant() const { return dds::ToText(connections_.back()->participant.guid_prefix()); }

  std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() override {
    CheckRole(Role::kService, "making a service's endpoint of another one's transport");
    std::vector<const DdsConnection*> groups;
    for (const auto& connection : connections_) groups.push_back(connection.get());
    return std::make_unique<dds::DdsServiceEndpoint>(groups, data_sharing_);
  }
  std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId) override {
    CheckRole(Role::kAgent, "making an agent's endpoint of another one's transport");
    return std::make_unique<dds::DdsAgentEndpoint>(*connections_.front(), service_, data_sharing_);
  }
  std::unique_ptr<ObserverEndpoint> MakeObserverEndpoint() override {
    CheckRole(Role::kObserver, "making an observer's endpoint of another one's transport");
    return std::make_unique<dds::DdsObserverEndpoint>(*connections_.front());
  }

 private:
  static std::string AgentOf(Role role, const DdsOptions& options) {
    return role == Role::kAgent ? AgentName(options.robots) : std::string();
  }

  void CheckRole(Role role, const char* doing) const {
    if (role != role_) throw dds::Exception(DDS_RETCODE_ILLEGAL_OPERATION, doing);
  }

  const Role role_;
  const std::optional<dds::GuidPrefix> service_;
  const bool data_sharing_;
  std::vector<std::unique_ptr<DdsConnection>> connections_;
};

// The partition is matched with wildcards, so a session's name must not contain any.
void CheckSession(const std::string& session) {
  if (session.find_first_of("*?[]") == std::string::npos) return;
  throw dds::Exception(DDS_RETCODE_BAD_PARAMETER,
                       "opening session '" + session + "' (expected a name without the wildcards * ? [ ])");
}

// With a long lease, too, a participant whose first announcement is lost is discovered soon.
constexpr double kAnnounceSeconds = 2.0;

DomainConfig ConfigOf(const DdsOptions& options) {
  DomainConfig config;
  config.domain = options.domain;
  config.network_interface = options.network_interface;
  config.network = options.network_profile;
  config.lease_seconds = options.lease();
  config.announce_seconds = kAnnounceSeconds;
  // With data sharing hardly any agent receives samples, so that heartbeats cost little. While agents start, they are
  // the answer to a reader that has asked for samples before its writer had discovered it.
  if (options.data_sharing) config.heartbeat_seconds = kHeartbeatWithSharing;
  config.linger_seconds = 0.0;  // the endpoints wait for acknowledgments
  dds::SetKeys(config, options.keys.enclave);
  return config;
}

// The configuration of an agent or an observer. They discover the service and not each other: one that announced itself
// by multicast would be discovered by every agent of the host, and discover all of them.
DomainConfig PeerConfig(const DdsOptions& options) {
  DomainConfig config = ConfigOf(options);
  config.discovery_multicast = false;
  config.describes_types = false;  // the service does
  config.max_sample_bytes = kMaxSampleForPeers;
  config.peers = {options.service_address.empty() ? "127.0.0.1" : options.service_address};
  return config;
}

// Calls create(config, port) with the first free participant index from `first` on, or with that of `port` if it is not
// 0. Cyclone could find an index itself, but does not tell which. Throws dds::Exception.
template <typename Create>
void CreateWithFreeIndex(DomainConfig config, std::uint32_t first, std::uint16_t port, const Create& create) {
  for (std::uint32_t index = port == 0 ? first : 0; index < kParticipantsOfMachine; ++index) {
    const std::uint16_t own = dds::DiscoveryPort(config.domain, index);
    if (port != 0 && port != own) continue;
    if (!dds::PortsAreFree(config.domain, index)) continue;
    config.participant_index = index;
    try {
      return create(config, own);
    } catch (const dds::Exception&) {
      if (dds::PortsAreFree(config.domain, index)) throw;  // otherwise another service was faster
    }
  }
  if (port != 0) {
    throw dds::Exception(DDS_RETCODE_OUT_OF_RESOURCES, "opening discovery port " + std::to_string(port) +
                                                           " (expected a free port of a participant in domain " +
                                                           std::to_string(config.domain) + ")");
  }
  throw dds::Exception(DDS_RETCODE_OUT_OF_RESOURCES,
                       "looking for a free participant index in domain " + std::to_string(config.domain));
}

// Bytes of a row without its lists, but with names of a usual length.
constexpr std::size_t kRowBytes = 1'000;

std::size_t ShapeBytes(const Shape& shape) {
  std::size_t bytes = kRowBytes + sizeof(Rectangle) * shape.rectangles.size();
  for (const Block& block : shape.blocks) bytes += kRowBytes + sizeof(Vec2) * block.outline.size();
  if (!shape.area) return bytes;
  const Bitmap& bitmap = shape.area->cover().bitmap();
  return bytes + static_cast<std::size_t>(bitmap.width()) * static_cast<std::size_t>(bitmap.height()) / 4;
}

std::size_t SensorBytes(const SensorDescription& sensor) {
  std::size_t bytes = 4 * kRowBytes;
  if (const auto* const ranger = std::get_if<RangerParameters>(&sensor.parameters)) {
    for (const RaySensorDescription& rays : *ranger->ray_sensors) {
      bytes += kRowBytes + sizeof(double) * rays.elevations.size();
    }
  }
  return bytes;
}

}  // namespace

std::size_t SessionBytes(const WorldDescription& world) {
  std::size_t bytes =
      kMaxSampleForService + kRowBytes * (world.models.size() + world.joints.size() + world.grippers.size() +
                                          world.objects.size() + world.doors.size() + world.people.size());
  for (const Shape& shape : world.shapes) bytes += ShapeBytes(shape);
  for (const RobotDescription& robot : world.robots) {
    bytes += 2 * kRowBytes + robot.controller.parameters.size();
    for (const SensorDescription& sensor : robot.sensors) bytes += SensorBytes(sensor);
  }
  return bytes;
}

DdsServiceTransport MakeDdsServiceTransport(const DdsOptions& options) {
  CheckSession(options.session);
  DdsServiceTransport made;
  DomainConfig config = ConfigOf(options);
  // Cyclone has one bound for what a participant receives and sends.
  config.max_sample_bytes = static_cast<std::uint32_t>(
      std::clamp<std::size_t>(options.session_bytes, kMaxSampleForService, kMaxSampleForPeers));
  std::unique_ptr<DdsTransport> transport;
  const auto create = [&](const DomainConfig& free, std::uint16_t port) {
    if (transport) {
      transport->Add(options, free);
    } else {
      transport = std::make_unique<DdsTransport>(DdsTransport::Role::kService, options, free);
    }
    made.participants.push_back({port, transport->participant()});
  };
  for (std::size_t group = 0; group < std::max(std::size_t{1}, options.agent_groups); ++group) {
    const std::uint16_t port = group < options.discovery_ports.size() ? options.discovery_ports[group] : 0;
    CreateWithFreeIndex(config, group == 0 ? 0 : dds::kPeerPortsTried, port, create);
    // The first participant is enough for discovery; agents of other groups are told their address.
    config.discovery_multicast = false;  // tools and other services are to discover the first one alone
  }
  made.transport = std::move(transport);
  return made;
}

std::unique_ptr<Transport> MakeDdsAgentTransport(const DdsOptions& options) {
  CheckSession(options.session);
  DomainConfig config = PeerConfig(options);
  // By multicast the service's answers to each agent that joins would reach all that have joined. Only frames on the
  // network are worth it.
  if (options.data_sharing && dds::NetworkProfile(config) == "one-host") config.data_multicast = false;
  return std::make_unique<DdsTransport>(DdsTransport::Role::kAgent, options, config);
}

std::unique_ptr<Transport> MakeDdsObserverTransport(const DdsOptions& options) {
  CheckSession(options.session);
  return std::make_unique<DdsTransport>(DdsTransport::Role::kObserver, options, PeerConfig(options));
}

std::string NetworkProfileOf(const NetworkSettings& network) {
  DomainConfig config;
  config.network_interface = network.network_interface;
  config.network = network.network_profile;
  return dds::NetworkProfile(config);
}

}  // namespace troupe
