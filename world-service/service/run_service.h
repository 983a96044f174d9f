// RunService: a whole run of the world service over a transport, from waiting for the agents to the summary. The
// program world-service and `troupe run --in-process` are thin shells around it.
//
// Threads: the calling thread is the only one that RunService itself uses. It waits for time (pacing, resends,
// deadlines), reads files of requests and the history, and reports progress. Deliveries of the transport arrive on the
// transport's threads, and make the step there: the last proposal of a tick is not handed over to another thread, which
// would cost a wake-up in every tick. One mutex serializes all of them at the coordinator; slow work happens without
// it.
//
// The clock is read here alone: all parts below get the time as a parameter, so that tests drive them by a time of
// their own, and no result can depend on it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/thread_pool.h"
#include "common/run/run_settings.h"
#include "common/spatial/scene.h"
#include "common/spatial/scene_cache.h"
#include "common/trace/tick_trace.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/robot_totals.h"
#include "world-service/service/run_history.h"
#include "world-service/service/run_observer.h"
#include "world-service/service/trip_totals.h"
#include "worldfile/load_world.h"

namespace troupe {

// RunSummary: the outcome of a run.
struct RunSummary {
  std::uint64_t ticks = 0;
  double sim_seconds = 0.0;
  double wall_seconds = 0.0;  // from the first tick to the last
  double real_time_factor = 0.0;
  double startup_seconds = 0.0;  // from the start of RunService to the first tick
  std::uint32_t robots = 0;
  std::uint64_t stalls = 0;    // kStallBegan events
  std::uint64_t rejected = 0;  // rejected proposals, reported as events or not
  std::uint64_t frames_repeated = 0;
  std::uint64_t state_hash = 0;
  std::vector<SlowRobot> slowest;  // at most five, slowest first
  std::vector<SlowRobot> ros;      // nodes and topics of ROS for which ticks waited, slowest first
  std::vector<std::string> lost;   // robots without an agent at the end
  std::uint64_t frozen = 0;        // robots that had no agent in one tick or more, and stood still
  bool interrupted = false;
  double record_waited_seconds = 0.0;  // wall time that ticks waited for an observer, the recording
  std::vector<RobotTotal> totals;      // of the first kMaxRobotTotals robots
  TrafficTotal traffic;                // of robots on lanes
  std::vector<PlaceWaits> waits;       // of the kMaxWaitPlaces lanes, doors and lifts with the most waiting
  std::uint64_t totals_since = 0;      // the tick from which on they count
  std::vector<FlowTotal> flows;        // of goods
  std::vector<CleaningTotal> cleaning;
  std::optional<TripSummary> trips;  // of a problem of paths
};
inline constexpr std::size_t kMaxWaitPlaces = 10;
inline constexpr std::size_t kMaxRobotTotals = 1000;

struct ServiceOptions {
  RunSettings settings;
  TraceOptions trace = {};
  std::string session;
  double lease_seconds = kDefaultLeaseSeconds;                 // an agent that is silent for longer is lost
  bool lease_is_limit = false;                                 // also if a launcher knows that its process lives
  double start_timeout_seconds = kDefaultStartTimeoutSeconds;  // for all robots to join; 0: wait for ever
  std::string advice_on_silence;       // for users, if agents do not answer the first frame; empty: none
  bool start_paused = false;           // at tick 0, until a tool plays or steps
  std::shared_ptr<ThreadPool> pool;    // of the step; null: one thread
  std::shared_ptr<SceneCache> scenes;  // for agents and viewers in this process; null: there are none
  std::string world_file;              // where models to spawn are defined; empty: nowhere
  LoadOverrides overrides;             // for worlds and models that are loaded during the run
  Incarnation first_incarnation = 0;   // of a service that begins a run
  std::optional<ResumedRun> resumed;   // a run to be continued, instead of a new one
  AllowedPaths libraries;              // controllers that those may name
  RunHistory* history = nullptr;       // for the memory of robots; null: none; outlives the run
  // Whether an edit may lead to this world, or add this entity; nothing: any.
  std::function<Status(const WorldDescription& world)> check_world = {};
  // Whether a robot at X_WR can reach a goal of a user; nothing: it tries.
  std::function<Status(const Scene& scene, RobotId robot, const Pose& X_WR, const Goal& goal)> check_goal = {};
};

// Runs until the settings' number of ticks, `stop`, or a failure. The error is for users: agents that did not join
// (named), an agent lost with on_agent_loss abort, a rival service in the session, the error of an observer. Destroys
// the endpoint before it returns: no delivery follows.
Result<RunSummary> RunService(const std::shared_ptr<const Scene>& scene, const ServiceOptions& options,
                              std::unique_ptr<ServiceEndpoint> endpoint, const RunObservers& observers,
                              const std::atomic<bool>& stop);

}  // namespace troupe
