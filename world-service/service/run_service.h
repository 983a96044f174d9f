// RunService: a whole run of the world service over a transport, from waiting for the agents to the summary. The program
// world-service and `troupe run --in-process` are thin shells around it.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/protocol/transport.h"
#include "common/spatial/scene.h"
#include "common/worldfile/load_world.h"

namespace troupe {

// Files to write while running; empty: none. docs/running.md has their formats.
struct OutputFiles {
  std::string hash_log;  // "tick hash" a line
  std::string poses;     // CSV: tick,robot,x,y,z,heading,stalled
  std::string record;    // JSON lines: header, then a line for each tick
};

struct ServiceOptions {
  RunSettings settings;
  OutputFiles outputs;
  std::string session;
  double lease_seconds = 2.0;           // an agent that the transport has not heard of for longer is gone
  double start_timeout_seconds = 60.0;  // for all robots to join; 0: wait for ever
};

struct SlowRobot {
  std::string robot;
  std::uint64_t times_last = 0;    // ticks in which its proposal was the last to arrive
  double waited_seconds = 0.0;     // wall time that the barrier waited for it alone
};

struct RunSummary {
  std::uint64_t ticks = 0;
  double sim_seconds = 0.0;
  double wall_seconds = 0.0;       // from the first tick to the last
  double real_time_factor = 0.0;
  double startup_seconds = 0.0;    // from the start of RunService to the first tick
  std::uint32_t robots = 0;
  std::uint64_t stalls = 0;        // kStallBegan events
  std::uint64_t rejected = 0;      // kProposalRejected events
  std::uint64_t frames_repeated = 0;
  std::uint64_t state_hash = 0;
  std::vector<SlowRobot> slowest;  // at most five, slowest first
  std::vector<std::string> lost;   // robots without an agent at the end
  bool interrupted = false;
};

// Told how the run goes, on the thread that runs it.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void OnStarted(double startup_seconds) = 0;         // all robots are there; the first tick follows
  virtual void OnStatus(const StatusMessage& status) = 0;     // about twice a second
  virtual void OnEvent(const Event& event, const std::string& text) = 0;  // text: one line for people
  // Anything else worth a line: what a controller reported, that a mode is not deterministic.
  virtual void OnNotice(const std::string& text) { (void)text; }
};

// Runs until the settings' number of ticks, `stop`, or a failure. The error is for people: agents that did not come
// (named), an agent lost with on_agent_loss abort, a rival service in the session, an output file that cannot be written.
// Takes the endpoint because its deliveries must end before this returns.
Result<RunSummary> RunService(const Scene& scene, const ServiceOptions& options,
                              std::unique_ptr<ServiceEndpoint> endpoint, RunObserver& observer,
                              const std::atomic<bool>& stop);

}  // namespace troupe
