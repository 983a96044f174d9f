#include "common/dds/transport/dds_transport.h"

#include "common/base/check.h"
#include "common/dds/binding/free_ports.h"
#include "common/dds/transport/dds_agent_endpoint.h"
#include "common/dds/transport/dds_observer_endpoint.h"
#include "common/dds/transport/dds_service_endpoint.h"
#include "common/protocol/agent_name.h"

namespace troupe {
namespace {

using dds::DdsConnection;
using dds::DomainConfig;

// Bounds the memory that a stranger's messages need. The longest that a service needs is the join or the proposal of an
// agent with a hundred thousand robots.
constexpr std::uint32_t kLargestSampleForService = 16'000'000;  // bytes
// Of agents and observers: the longest is a world.
constexpr std::uint32_t kLargestSampleForPeers = 1'000'000'000;

constexpr std::uint32_t kServicesOfMachine = 100;  // that share a domain: their participant indices

std::optional<dds::GuidPrefix> ServiceOf(const DdsOptions& options) {
  if (options.service_participant.empty()) return std::nullopt;
  const std::optional<dds::GuidPrefix> prefix = dds::ParseGuidPrefix(options.service_participant);
  if (prefix) return prefix;
  throw dds::Exception(DDS_RETCODE_BAD_PARAMETER, "looking for the participant '" + options.service_participant +
                                                      "' (expected 24 hexadecimal digits)");
}

// A participant, for the endpoints of one role: its discovery settings suit no other one.
class DdsTransport : public Transport {
 public:
  enum class Role { kService, kAgent, kObserver };

  DdsTransport(Role role, const DdsOptions& options, const DomainConfig& config)
      : role_(role),
        connection_(config, options.session, options.on_problem, options.keys.token, AgentOf(role, options)),
        service_(ServiceOf(options)),
        data_sharing_(options.data_sharing) {
    connection_.on_foreign_run = options.on_foreign_run;
  }

  std::string participant() const { return dds::ToText(connection_.participant.guid_prefix()); }

  std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() override {
    CheckRole(Role::kService, "making a service's endpoint of another one's transport");
    return std::make_unique<dds::DdsServiceEndpoint>(connection_, data_sharing_);
  }
  std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId) override {
    CheckRole(Role::kAgent, "making an agent's endpoint of another one's transport");
    return std::make_unique<dds::DdsAgentEndpoint>(connection_, service_, data_sharing_);
  }
  std::unique_ptr<ObserverEndpoint> MakeObserverEndpoint() override {
    CheckRole(Role::kObserver, "making an observer's endpoint of another one's transport");
    return std::make_unique<dds::DdsObserverEndpoint>(connection_);
  }

 private:
  static std::string AgentOf(Role role, const DdsOptions& options) {
    return role == Role::kAgent ? AgentName(options.robots) : std::string();
  }

  void CheckRole(Role role, const char* doing) const {
    if (role != role_) throw dds::Exception(DDS_RETCODE_ILLEGAL_OPERATION, doing);
  }

  const Role role_;
  DdsConnection connection_;
  const std::optional<dds::GuidPrefix> service_;
  const bool data_sharing_;
};

// The partition is matched with wildcards, so a session's name must not contain any.
void CheckSession(const std::string& session) {
  if (session.find_first_of("*?[]") == std::string::npos) return;
  throw dds::Exception(DDS_RETCODE_BAD_PARAMETER,
                       "opening session '" + session + "' (expected a name without the wildcards * ? [ ])");
}

DomainConfig ConfigOf(const DdsOptions& options) {
  DomainConfig config;
  config.domain = options.domain;
  config.network_interface = options.network_interface;
  config.network = options.network_profile;
  config.lease_seconds = options.lease_seconds;
  config.security_enclave = options.keys.enclave;
  return config;
}

// Of an agent or an observer. They discover the service and not each other: one that announced itself by multicast
// would be discovered by every agent of the host, and discover all of them.
DomainConfig PeerConfig(const DdsOptions& options) {
  DomainConfig config = ConfigOf(options);
  config.discovery_multicast = false;
  config.max_sample_bytes = kLargestSampleForPeers;
  config.peers = {options.service_address.empty() ? "127.0.0.1" : options.service_address};
  return config;
}

}  // namespace

DdsServiceTransport MakeDdsServiceTransport(const DdsOptions& options) {
  CheckSession(options.session);
  DomainConfig config = ConfigOf(options);
  config.max_sample_bytes = kLargestSampleForService;
  // The first free index, found by trying: Cyclone could find one itself, but does not tell which.
  for (std::uint32_t index = 0; index < kServicesOfMachine; ++index) {
    const std::uint16_t port = dds::DiscoveryPort(options.domain, index);
    if (options.discovery_port != 0 && options.discovery_port != port) continue;
    if (!dds::PortsAreFree(options.domain, index)) continue;
    config.participant_index = index;
    try {
      auto transport = std::make_unique<DdsTransport>(DdsTransport::Role::kService, options, config);
      std::string participant = transport->participant();
      return {std::move(transport), port, std::move(participant)};
    } catch (const dds::Exception&) {
      if (dds::PortsAreFree(options.domain, index)) throw;  // otherwise another service was faster
    }
  }
  if (options.discovery_port != 0) {
    throw dds::Exception(DDS_RETCODE_OUT_OF_RESOURCES, "opening discovery port " +
                                                           std::to_string(options.discovery_port) +
                                                           " (expected a free port of a participant in domain " +
                                                           std::to_string(options.domain) + ")");
  }
  throw dds::Exception(DDS_RETCODE_OUT_OF_RESOURCES,
                       "looking for a free participant index in domain " + std::to_string(options.domain));
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

}  // namespace troupe
