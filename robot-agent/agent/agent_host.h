// AgentHost: one or more robots in one agent process, around one replica of the world. It joins, answers each frame
// with one proposal message, and leaves when the run is over.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/protocol/transport.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/gateway.h"

namespace troupe {

struct AgentOptions {
  AgentId agent = 0;
  std::vector<std::string> robots;  // names; empty: every robot of the world
  std::string scan_log;             // file for all scans; empty: none
  bool keep_scan_log = false;       // add to what the file holds
  TraceOptions trace = {};
  std::size_t threads = 1;  // that share the robots; with a scan log always one, so that scans come in order
  double session_timeout_seconds = 60;  // for a session to appear; 0: wait for ever
  MakeGateway make_gateway = {};        // empty: none
};

// Runs until the service ends the run (true), `stop` (false), or a failure: no session, refused (the service's reason),
// another protocol version, a controller that cannot be made, the service gone, a scan log that cannot be written.
// Takes the endpoint because its deliveries must end before this returns. `bad_request`, if given, is set when the
// failure is for whoever started the agent to mend: a robot that is unknown or taken, a controller that cannot be made.
Result<bool> RunAgent(std::unique_ptr<AgentEndpoint> endpoint, const AgentOptions& options,
                      const std::atomic<bool>& stop, bool* bad_request = nullptr);

}  // namespace troupe
