// RunService: a whole run of the world service over a transport, from waiting for the agents to the summary. The
// program world-service and `troupe run --in-process` are thin shells around it.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/protocol/transport.h"
#include "common/spatial/scene.h"
#include "common/trace/tick_trace.h"
#include "common/worldfile/load_world.h"
#include "world-service/service/recorder.h"
#include "world-service/service/run_summary.h"
#include "world-service/service/world_gateway.h"

namespace troupe {

struct ServiceOptions {
  RunSettings settings;
  OutputFiles outputs;
  TraceOptions trace = {};
  std::string session;
  double lease_seconds = 2.0;           // an agent that the transport has not heard of for longer is gone
  double start_timeout_seconds = 60.0;  // for all robots to join; 0: wait for ever
  MakeWorldGateway make_gateway;        // empty: none
  bool start_paused = false;            // at tick 0, until somebody plays or steps
  std::string world_file;               // where models to spawn are defined; empty: nowhere
  LoadOverrides overrides;              // for worlds and models that are loaded during the run
};

// Told how the run goes, on the thread that runs it.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void OnStarted(double startup_seconds) = 0;  // all robots are there; the first tick follows
  virtual void OnStatus(
      const StatusMessage& status) = 0;  // twice a second; before the run begins, when agents come, too
  virtual void OnEvent(const Event& event, const std::string& text) = 0;  // text: one line for people
  // An edit has brought robots that have no agents yet; somebody has to start them.
  virtual void OnNewRobots(const std::vector<std::string>& robots) { (void)robots; }
  // Anything else worth a line: what a controller reported, that a mode is not deterministic.
  virtual void OnNotice(const std::string& text) { (void)text; }
};

// Runs until the settings' number of ticks, `stop`, or a failure. The error is for people: agents that did not come
// (named), an agent lost with on_agent_loss abort, a rival service in the session, an output file that cannot be
// written. Takes the endpoint because its deliveries must end before this returns.
Result<RunSummary> RunService(const Scene& scene, const ServiceOptions& options,
                              std::unique_ptr<ServiceEndpoint> endpoint, RunObserver& observer,
                              const std::atomic<bool>& stop);

}  // namespace troupe
