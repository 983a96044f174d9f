// LiveRun: the part of a run's state that the parts of the coordinator share. A plain struct; each member names the one
// class that writes it (all of them may read). Used by one thread at a time.
//
// Why a struct and not accessors: TickEngine, WorldEditor, RunControl and RunStatistics describe one run from different
// sides, and most decisions need several members at once (phase, frame, members). Passing each by parameter hid who
// writes what; here the writer of a member is one word beside it. What only one part needs is private to that part.
//
// `frame` is the truth about the newest committed state: a state is committed by assigning it (TickEngine::Publish),
// after all observers have accepted it. All times are wall times in s of the coordinator's clock.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/thread_pool.h"
#include "common/run/run_settings.h"
#include "common/spatial/scene.h"
#include "common/spatial/scene_cache.h"
#include "common/trace/tick_trace.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"
#include "world-service/service/event_log.h"
#include "world-service/service/membership.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/robot_memories.h"
#include "world-service/service/run_observer.h"
#include "world-service/service/vehicle_states.h"

namespace troupe {

struct CoordinatorOptions {
  RunSettings settings;
  RunId run = 0;  // random; of two services that gather agents in one session, the one with the lower id remains
  Incarnation incarnation = 0;  // of this service
  double lease_seconds = 2.0;
  bool lease_is_limit = false;          // an agent whose lease has expired is lost, though its process lives
  double start_timeout_seconds = 60.0;  // for all robots to join; 0: wait for ever
  std::string advice_on_silence = {};   // for users, if agents do not answer the first frame; empty: none
  bool start_paused = false;            // at tick 0
  bool has_history = false;             // agents can be sent the states of the past
  std::shared_ptr<ThreadPool> pool;     // of the step; null: one thread
  std::shared_ptr<SceneCache> scenes;   // for agents and viewers in this process; null: there are none
  TraceLane* trace = nullptr;           // outlives the coordinator; null: none
  PhaseTimes* phase_times = nullptr;    // as above
  std::string host;                     // of this process, for the session
  std::uint32_t pid = 0;
  // ServiceOptions::check_world.
  std::function<Status(const WorldDescription& world)> check_world = {};
  // LoadOverrides::check_in_world, of robots that are spawned.
  std::function<Status(const WorldDescription& world, std::span<const RobotId> robots)> check_in_world = {};
  // ServiceOptions::check_goal.
  std::function<Status(const Scene& scene, RobotId robot, const Pose& X_WR, const Goal& goal)> check_goal = {};
  std::optional<ResumedRun> resumed = {};  // a run to be continued; then `run` and `incarnation` are its
};

enum class RunPhase : std::uint8_t {
  kGathering,  // waiting for an agent for every robot
  kRunning,    // ticking
  kEnding,     // the last frame is out; waiting for the agents to leave
  kOver,
};

struct LiveRun {
  // Constant.
  const CoordinatorOptions options;
  ServiceEndpoint& endpoint;
  const RunObservers observers;
  const double created_at;  // wall time, s

  // Written by TickEngine.
  RunPhase phase = RunPhase::kGathering;
  std::optional<double> started_at = {};      // wall time of frame 0, s, once it is sent
  Status error = {};                          // of a run that failed
  bool interrupted = false;                   // by Stop
  std::vector<std::string> lost_robots = {};  // without an agent at the end

  // Written by WorldEditor when an edit is applied.
  std::shared_ptr<const Scene> scene;
  // Written by TickEngine.
  FrameMessage frame = {};  // the newest that the agents were sent; before the run begins, the first
  // Written by TickEngine (steps) and WorldEditor (fresh starts).
  VehicleStates vehicle_states = {};

  // Written by TickEngine (steps) and WorldEditor (edits).
  RobotMemories memories = {};
  bool restoring = false;  // until the next step: all agents need the memory of the states since the fresh start

  // Written by TickEngine (presence, answers) and TickCoordinator (joins).
  Membership members;

  // Written by TickCoordinator: an agent that has joined again has decided on the frame with which the run continues.
  bool is_decided = false;

  // Written by WorldEditor: robots of the newest edit that have no agent yet.
  std::vector<RobotId> newcomers = {};
  // Written by TickCoordinator: by the name of a controller, whether it accepts goals, as its agents have said.
  std::map<std::string, bool> accepts_goals = {};

  // Written by all parts.
  EventLog events = {};
  NoticeList notices = {};

  const WorldDescription& world() const { return scene->world(); }
  bool realtime() const { return options.settings.mode == Mode::kRealtime; }
  bool is_branch() const { return options.resumed && options.resumed->is_branch; }
  // It begins with a state that another run or service has committed.
  bool continues() const { return options.resumed && options.resumed->frame; }
  // Whether the run is that of a service that has died: its agents will join again.
  bool takes_over() const { return continues() && !is_branch(); }
  // Agents that join are sent the states that their robots do not remember.
  bool restores_memory() const {
    return options.has_history && (restoring || options.settings.on_agent_loss == OnAgentLoss::kRebuild);
  }
  Tick next_tick() const { return frame.state.tick + 1; }
  StatePlace next_place() const { return {frame.edition, next_tick()}; }
};

// Sends the session: the process of the service and its world.
void AnnounceSession(const LiveRun& run);

// The frame that follows another one, without its state and what belongs to that.
FrameMessage SuccessorOf(const FrameMessage& frame);

// `taken`: as AdmissionMessage::taken.
AdmissionMessage MakeAdmission(const LiveRun& run, AgentId agent, bool admitted, std::string reason = {},
                               std::vector<std::string> taken = {});

// "r0, r1 and 5 more": the names of at most ten robots.
std::string ListNames(const WorldDescription& world, const std::vector<RobotId>& robots);

}  // namespace troupe
