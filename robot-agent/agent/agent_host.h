// AgentHost: one or more robots in one agent process, around one replica of the world: the threads and the clock of an
// AgentProtocol.
#pragma once

#include <memory>
#include <stop_token>

#include "robot-agent/agent/agent_options.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe {

// Runs until the service ends the run, a stop request, or a failure: no session, a refusal by the service, another
// protocol version, a service that is gone and does not return, a scan log that cannot be written. The code of the
// error is kBadInput if the caller can correct it: a robot that is unknown or has an agent already, a controller that
// cannot be made, an output file that cannot be opened. Owns the endpoint, because its deliveries must end before this
// returns.
Result<AgentEnd> RunAgent(std::unique_ptr<AgentEndpoint> endpoint, const AgentOptions& options, std::stop_token stop);

}  // namespace troupe
