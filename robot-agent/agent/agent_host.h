// AgentHost: one or more robots in one agent process, around one replica of the world: the threads and the clock of an
// AgentProtocol.
//
// Two threads. The transport's delivery thread brings frames, decides and answers inside the delivery, without handing
// a frame over: the way of a tick from frame to answer has no switch of threads. The thread of RunAgent does all that
// may take long: it sends joins, makes and changes replicas, prints notices. One lock guards the protocol; it is
// released for tasks, for sends of joins and for notices, because each of them may wait for a delivery.
//
// An agent survives its service: when the lease expires it waits, and joins again the service that returns or continues
// the run. It ends by the end of the run, a stop request or a failure; the caller decides on the exit status by the
// error's code.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "common/base/thread_pool.h"
#include "common/spatial/scene_cache.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/gateway.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe {

// AgentOptions: the settings of an agent.
struct AgentOptions {
  AgentId agent = 0;
  std::vector<std::string> robots;  // names; empty: every robot of the world
  // Leave out the robots that the world does not have, or that have another agent; without any, the run is over for it.
  bool skip_unavailable = false;
  std::string scan_log;         // file for the readings of all sensors; empty: none
  bool keep_scan_log = false;   // append to the file
  AllowedPaths libraries = {};  // that may be a robot's controller
  TraceOptions trace = {};
  // Threads that divide the robots; null, and with a scan log, for the order of its lines: one.
  std::shared_ptr<ThreadPool> pool = {};
  std::shared_ptr<SceneCache> scenes = {};  // of the process; null: one of the agent
  double session_timeout_seconds = 60;      // to wait for a session, at first or again; 0: without limit
  MakeGateway make_gateway = {};            // empty: none
  // Receives lines for the terminal, on the thread of RunAgent; may be empty.
  std::function<void(const std::string&)> on_notice = {};
};

enum class AgentEnd : std::uint8_t {
  kRunOver,  // the service ended the run, or an edit removed all robots of the agent, or others have them
  kStopped,  // by a stop request
};

// Runs until the service ends the run, a stop request, or a failure: no session, a refusal by the service, another
// protocol version, a service that is gone and does not return, a scan log that cannot be written. The code of the
// error is kBadInput if the caller can correct it: a robot that is unknown or has an agent already, a controller that
// cannot be made, an output file that cannot be opened. Owns the endpoint, because its deliveries must end before this
// returns.
Result<AgentEnd> RunAgent(std::unique_ptr<AgentEndpoint> endpoint, const AgentOptions& options, std::stop_token stop);

}  // namespace troupe
