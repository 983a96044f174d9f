// DdsTransport: the tick protocol over Cyclone DDS, between any number of processes and machines. docs/qos.md describes
// discovery and QoS.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/protocol/transport.h"

namespace troupe {

struct DdsOptions {
  std::uint32_t domain = 42;             // simulation domain, 0 to 230; ROS 2 uses another one
  std::string session;                   // DDS partition: runs in different sessions never meet; no "*" or "?" in it
  std::string network_interface = "lo";  // name or address of a network interface; "auto": Cyclone's choice
  std::string network;                   // profile of domain_config.h; empty: by the interface
  std::string service_address;           // agents: where the service is, "host" or "host:port"; empty: on this machine
  double lease_seconds = 2.0;            // who is silent for longer is gone
  // Told, in one line and on any thread, of each message that was ignored because it was malformed, or could not be
  // sent.
  std::function<void(const std::string&)> on_problem;
};

// A participant of its own each. Both throw dds::Exception (common/dds/exception.h) when DDS cannot start. A service
// transport makes service endpoints only, an agent transport agent endpoints only. `discovery_port`, unless null, gets
// the port for the agents' service_address.
std::unique_ptr<Transport> MakeDdsServiceTransport(const DdsOptions& options, std::uint16_t* discovery_port);
std::unique_ptr<Transport> MakeDdsAgentTransport(const DdsOptions& options);

}  // namespace troupe
