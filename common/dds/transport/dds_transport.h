// DdsTransport: the tick protocol over Cyclone DDS, between any number of processes and hosts. docs/qos.md describes
// discovery and QoS.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/protocol/transport.h"
#include "common/run/network_settings.h"
#include "common/security/session_keys.h"

namespace troupe {

struct DdsOptions : NetworkSettings {
  ParticipantKeys keys;
  std::uint16_t discovery_port = 0;  // of a service, one that DDS has for this domain; 0: the first free one
  std::vector<std::string> robots;   // of an agent: it may join for these only
  // Called, on any thread, when a run of this session has a token that `keys` lacks.
  std::function<void()> on_foreign_run;
  // Called, on any thread, with one line for each message that was ignored because it was malformed, or could not be
  // sent.
  std::function<void(const std::string&)> on_problem;
};

// A participant of its own each. All throw dds::Exception (common/dds/binding/exception.h) when DDS cannot start. A
// service transport makes service endpoints only, an agent transport agent endpoints, an observer transport observer
// endpoints.
struct DdsServiceTransport {
  std::unique_ptr<Transport> transport;
  std::uint16_t discovery_port = 0;  // for the service_address of agents and observers
  std::string participant;           // for the service_participant of agents
};
DdsServiceTransport MakeDdsServiceTransport(const DdsOptions& options);
std::unique_ptr<Transport> MakeDdsAgentTransport(const DdsOptions& options);
std::unique_ptr<Transport> MakeDdsObserverTransport(const DdsOptions& options);

}  // namespace troupe
