// DdsTransport: the tick protocol over Cyclone DDS, between any number of processes and hosts. docs/qos.md describes
// discovery and QoS.
//
// One transport is for one role: service, agent or observer. Roles differ in how they are discovered. A service
// announces itself, by multicast where the network has it; agents and observers know only services (their peers), and
// never each other, so that the number of discovered pairs grows with the number of robots, not with its square.
//
// All names of topics, their QoS and their types are fixed (transport/protocol/messages.h, qos_profiles.h, idl/).
// Sessions of one domain are kept apart by DDS partitions, runs within a session by their ids.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "transport/protocol/transport.h"
#include "transport/security/session_keys.h"

namespace troupe {

struct DdsOptions : NetworkSettings {
  ParticipantKeys keys;
  // The groups of agents of a service, each with a participant of its own (dds_service_endpoint.h). At least 1.
  std::size_t agent_groups = 1;
  std::size_t session_bytes = 0;  // of a service: SessionBytes of its largest world
  // The UDP ports of a service that DDS has for this domain, of the participants of its groups; missing ones are the
  // first free ports.
  std::vector<std::uint16_t> discovery_ports;
  std::vector<std::string> robots;  // of an agent: it may join for these only
  // Called, on any thread, when a run of this session has a token that `keys` lacks.
  std::function<void()> on_foreign_run;
  // Called, on any thread, with one line for each message that was ignored because it was malformed, or could not be
  // sent.
  std::function<void(const std::string&)> on_problem;
};

// A participant of its own each. All throw dds::Exception (transport/dds/binding/entity.h) when DDS cannot start. A
// service transport makes service endpoints only, an agent transport agent endpoints, an observer transport observer
// endpoints.
struct DdsServiceTransport {
  std::unique_ptr<Transport> transport;
  // The participant of each group of agents; the first is for observers, too, and for agents that are not assigned to a
  // group.
  std::vector<ServiceParticipant> participants;
};
DdsServiceTransport MakeDdsServiceTransport(const DdsOptions& options);
std::unique_ptr<Transport> MakeDdsAgentTransport(const DdsOptions& options);
std::unique_ptr<Transport> MakeDdsObserverTransport(const DdsOptions& options);

// A bound for the bytes of the session message with this world: not too low, and seldom more than ten times too high.
std::size_t SessionBytes(const WorldDescription& world);

// The network profile that these settings name, or else that of their interface (configs/cyclone).
std::string NetworkProfileOf(const NetworkSettings& network);

}  // namespace troupe
