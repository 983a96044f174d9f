// The number of groups into which a service divides its agents (transport/dds/transport/agent_group.h).
#pragma once

#include <cstddef>

#include "world-service/program/command_line.h"

namespace troupe {

// More than one for a service that a launcher has started, because only a launcher assigns agents to groups, on the
// loopback interface with data sharing and without DDS Security: elsewhere a frame is written once for each group. A
// service that continues a run has at least as many as the one before it, whose ports are given.
std::size_t CountAgentGroups(const ServiceCommandLine& line, const LoadedWorld& loaded, bool secured);

}  // namespace troupe
