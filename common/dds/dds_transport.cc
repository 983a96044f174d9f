#include "common/dds/dds_transport.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/base/check.h"
#include "common/dds/dds_agent_endpoint.h"
#include "common/dds/dds_service_endpoint.h"

namespace troupe {
namespace {

using dds::DdsConnection;
using dds::DomainConfig;

constexpr std::uint32_t kServicesOfMachine = 100;  // that share a domain: their participant indices

class DdsServiceTransport : public Transport {
 public:
  explicit DdsServiceTransport(std::unique_ptr<DdsConnection> connection) : connection_(std::move(connection)) {}
  std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() override {
    return std::make_unique<dds::DdsServiceEndpoint>(*connection_);
  }
  std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId) override {
    dds::Check(DDS_RETCODE_ILLEGAL_OPERATION, "making an agent's endpoint of a service's transport");
    return nullptr;
  }

 private:
  std::unique_ptr<DdsConnection> connection_;
};

class DdsAgentTransport : public Transport {
 public:
  explicit DdsAgentTransport(std::unique_ptr<DdsConnection> connection) : connection_(std::move(connection)) {}
  std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() override {
    dds::Check(DDS_RETCODE_ILLEGAL_OPERATION, "making a service's endpoint of an agent's transport");
    return nullptr;
  }
  std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId) override {
    return std::make_unique<dds::DdsAgentEndpoint>(*connection_);
  }

 private:
  std::unique_ptr<DdsConnection> connection_;
};

// The partition is matched with wildcards, so a session's name must not hold any.
void CheckSession(const std::string& session) {
  if (session.find_first_of("*?[]") == std::string::npos) return;
  throw dds::Exception(DDS_RETCODE_BAD_PARAMETER,
                       "opening session '" + session + "' (expected a name without the wildcards * ? [ ])");
}

std::unique_ptr<DdsConnection> Connect(const DdsOptions& options, const DomainConfig& config) {
  return std::make_unique<DdsConnection>(config, options.session, options.on_problem);
}

bool IsFree(std::uint16_t port) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return true;  // DDS will say what is wrong
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool free = bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(socket);
  return free;
}

// A participant's data port is the one after its discovery port.
bool PortsAreFree(std::uint16_t discovery_port) {
  return IsFree(discovery_port) && IsFree(static_cast<std::uint16_t>(discovery_port + 1));
}

}  // namespace

std::unique_ptr<Transport> MakeDdsServiceTransport(const DdsOptions& options, std::uint16_t* discovery_port) {
  CheckSession(options.session);
  DomainConfig config;
  config.domain = options.domain;
  config.network_interface = options.network_interface;
  config.network = options.network;
  config.lease_seconds = options.lease_seconds;
  // The first free index, found by trying: Cyclone could find one itself, but does not tell which.
  for (std::uint32_t index = 0; index < kServicesOfMachine; ++index) {
    const std::uint16_t port = dds::DiscoveryPort(options.domain, index);
    if (!PortsAreFree(port)) continue;
    config.participant_index = index;
    try {
      auto transport = std::make_unique<DdsServiceTransport>(Connect(options, config));
      if (discovery_port != nullptr) *discovery_port = port;
      return transport;
    } catch (const dds::Exception&) {
      if (PortsAreFree(port)) throw;  // otherwise somebody else was faster
    }
  }
  throw dds::Exception(DDS_RETCODE_OUT_OF_RESOURCES,
                       "looking for a free participant index in domain " + std::to_string(options.domain));
}

std::unique_ptr<Transport> MakeDdsAgentTransport(const DdsOptions& options) {
  CheckSession(options.session);
  DomainConfig config;
  config.domain = options.domain;
  config.network_interface = options.network_interface;
  config.network = options.network;
  config.lease_seconds = options.lease_seconds;
  config.discovery_multicast = false;
  config.peers = {options.service_address.empty() ? "127.0.0.1" : options.service_address};
  return std::make_unique<DdsAgentTransport>(Connect(options, config));
}

}  // namespace troupe
