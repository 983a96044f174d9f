// AgentHost: one or more robots in one agent process, around one replica of the world. It joins a run, answers each
// frame with one proposal message, and leaves at the end of the run.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/base/allowed_paths.h"
#include "common/base/result.h"
#include "common/protocol/transport.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/gateway.h"

namespace troupe {

struct AgentOptions {
  AgentId agent = 0;
  std::vector<std::string> robots;  // names; empty: every robot of the world
  std::string scan_log;             // file for the readings of all sensors; empty: none
  bool keep_scan_log = false;       // append to the file
  AllowedPaths libraries = {};      // that may be a robot's controller
  TraceOptions trace = {};
  std::size_t threads = 1;              // that divide the robots; one with a scan log, for the order of its lines
  double session_timeout_seconds = 60;  // to wait for a session; 0: without limit
  MakeGateway make_gateway = {};        // empty: none
};

enum class AgentEnd : std::uint8_t {
  kRunOver,  // the service ended the run, or an edit removed all robots of the agent
  kStopped,  // by `stop`
};

// Runs until the service ends the run, `stop` becomes true, or a failure: no session, a refusal by the service, another
// protocol version, a lost service, a scan log that cannot be written. The code of the error is kBadInput if the caller
// can correct it: a robot that is unknown or has an agent already, a controller that cannot be made, an output file
// that cannot be opened. Owns the endpoint, because its deliveries must end before this returns.
Result<AgentEnd> RunAgent(std::unique_ptr<AgentEndpoint> endpoint, const AgentOptions& options,
                          const std::atomic<bool>& stop);

}  // namespace troupe
