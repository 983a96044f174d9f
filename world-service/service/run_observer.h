// RunObserver: follows a run of the world service. A run has a list of observers, several of a kind if need be; none of
// them can change a result. An observer overrides the calls that it needs.
//
// Threads: OnBegin, OnEnd and the progress reports are called on the thread of RunService, one at a time. OnTick and
// OnWorldChange are called on any thread, one at a time, between OnBegin and OnEnd, and so are all calls but the
// reports. Each is in a turn of the run, which has its lock: a delivery or the passing of time, then the requests made
// meanwhile with their replies, until none is left.
//
// An observer influences when the next tick is made (IsReady, IsPrepared, ShowsTick, Release), never what it contains:
// its only way into a state is WorldControl, by requests that are recorded as any others. So a run has the same hashes
// with any set of observers.
//
// Order in a tick: OnCommit of all, then the frame goes out to the agents, then OnTick of all while the agents work.
// What must not be lost with the process (the journal) is written in OnCommit, at the cost of the tick's time; all
// other work belongs to OnTick, which overlaps with the agents' decisions. Costs: a call of each per observer and tick,
// on the thread that made the step, under the lock of the run.
//
// Errors: one error ends the run in order; it is told once, and OnEnd still follows.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/run/run_settings.h"
#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/run_progress.h"
#include "troupe/result.h"

namespace troupe {

// Receives the reply to a request, once: from inside the request or later, on any thread. It must be quick; it may make
// another request.
using ControlReplyTo = std::function<void(const ControlReply&)>;

// News from a launcher of the process of an agent.
struct AgentNews {
  AgentId agent = 0;
  std::string end = {};  // how it ended, for users; empty: it has started, and its end will be reported
};

// Pauses, plays and steps a run and edits its world, for a tool (troupe ctl) or a gateway (ROS 2 services).
class WorldControl {
 public:
  virtual ~WorldControl() = default;
  virtual void Request(const control::Request& request, ControlReplyTo reply) = 0;
  // Makes a turn of the run, in which the observers are called (OnWake) and asked again whether it can continue: what
  // one of them waited for has come. In a turn it returns at once, and a turn follows, before which
  // deliveries may come. It locks the run.
  virtual void Wake() {}
  virtual void OnAgentNews(const AgentNews& /*news*/) {}
};

// What a shown tick waits for.
struct TickRelease {
  bool is_released = true;
  std::vector<std::string> awaited = {};  // for users; not empty if it is not released
};

// The start of a run.
struct RunStart {
  RunId run = 0;
  const RunSettings& settings;
  const std::shared_ptr<const Scene>& scene;  // of the description as loaded, which has the seed; of a resumed run: now
  WorldControl& control;                      // valid until OnEnd returns
  Tick tick = 0;                              // of the state with which the service begins; 0 or of a resumed run
  Incarnation incarnation = 0;                // of the service
};

// An edit that was applied: with the description that the frame before has, it determines the next state.
struct AppliedEdit {
  const control::Request& request;  // of kind kEdit, with the name that a spawned entity was given
  const WorldDescription* world =
      nullptr;  // LoadWorld: the world. Spawn: one with only the entity to add. Delete: with the one that a later
                // request may restore; null: none may. Rewind: the restored one. Else null.
  const WorldState* restored = nullptr;  // Rewind: the state in that world
};

// A committed state, with the inputs that led to it. The references are valid during the call.
struct CommittedTick {
  const FrameMessage& frame;            // tick, edition, state, its hash, the ordered events
  std::span<const Proposal> proposals;  // that entered the step, in robot-id order; empty for tick 0 and after an edit
  const AppliedEdit* edit = nullptr;    // null: the frame is tick 0 of the loaded world, or the result of a step
  const WorldState* before = nullptr;   // the state to which the edit was applied; null without one
  std::span<const RobotCommand> commands = {};  // from outside, that the agents had for the proposals
  std::span<const Input> inputs = {};           // of tools, that entered the step, in the sequence of their execution
  bool is_recorded = false;                     // the recording has the state already: the copy of one from the past
};

// A robot, or another participant, for which ticks have waited.
struct SlowRobot {
  std::string robot;
  std::uint64_t times_last = 0;  // ticks in which its proposal was the last to arrive
  double waited_seconds = 0.0;   // wall time that the barrier waited for it alone
};

class RunObserver {
 public:
  virtual ~RunObserver() = default;

  // Before the first agent is admitted. An error ends the run before it begins.
  virtual Status OnBegin(const RunStart& /*start*/) { return {}; }
  // After the last tick, once for each OnBegin that succeeded. An error makes the run fail.
  virtual Status OnEnd() { return {}; }

  // Before the agents are sent the frame, which wait for it: what is written here survives this process, whatever the
  // agents see. `progress`: after the tick. An error ends the run, and makes it fail.
  virtual Status OnCommit(const CommittedTick& /*tick*/, const RunProgress& /*progress*/) { return {}; }
  // Before the run continues after a pause, or when a pause that was to end remains. As OnCommit.
  virtual Status OnProgress(const RunProgress& /*progress*/) { return {}; }
  // After the agents were sent the frame; resent frames are not reported. The call must be quick: the next tick waits
  // for it. An error ends the run, and makes it fail.
  virtual Status OnTick(const CommittedTick& /*tick*/) { return {}; }
  // False while the observer cannot accept a tick: the run then waits before the next one, and asks again soon. Must be
  // quick.
  virtual bool IsReady() { return true; }
  // The same for a wait of less than a tick's time, after which the observer calls WorldControl::Wake.
  virtual bool IsPrepared() { return true; }
  // A call of WorldControl::Wake, in any pause, too. As OnTick.
  virtual Status OnWake() { return {}; }
  // Whether the agents are to publish this tick before they decide on it: the frame is then sent as in a pause first,
  // and the run resumes once the tick is released. Hashes change by inputs from outside alone.
  virtual bool ShowsTick(Tick /*tick*/) { return false; }
  // All agents have published a paused frame: once for each, also in a pause that stays.
  virtual Status OnShown(const FrameMessage& /*frame*/) { return {}; }
  // Whether agents may decide on the shown frame. An error ends the run, and makes it fail. Must be quick.
  virtual Result<TickRelease> Release() { return TickRelease{}; }
  // For the summary: those for which ticks have waited, longest first.
  virtual std::vector<SlowRobot> SlowestAwaited() { return {}; }
  // The frames from the next one on are of another description, after an edit. As OnTick. An error is
  // returned by the OnTick that follows.
  virtual void OnWorldChange(const std::shared_ptr<const Scene>& /*scene*/, Edition /*edition*/) {}

  // Progress reports. Ticks do not wait for these.
  virtual void OnStarted(double /*startup_seconds*/) {}      // all robots have agents; the first tick follows
  virtual void OnStatus(const StatusMessage& /*status*/) {}  // twice a second; before the first tick, at each join, too
  virtual void OnEvent(const Event& /*event*/, const std::string& /*text*/) {}  // text: one line for users
  // The robots of an edit, which made this edition; agents have to be started for them. A service that continues a run
  // repeats the report of the newest edit.
  virtual void OnNewRobots(const std::vector<std::string>& /*robots*/, Edition /*edition*/) {}
  virtual void OnNotice(const std::string& /*text*/) {}  // any other line for users, for instance of a controller
};

// The observers of a run, in the order in which they are called. Each outlives the run.
using RunObservers = std::vector<RunObserver*>;

}  // namespace troupe
