// RunControl: executes the requests of tools: pause, play, step, edits and queries. It keeps the open requests, in the
// order of their arrival, and replies to each once. docs/tick-protocol.md describes the pause.
//
// Requests for doors, lifts and twists are inputs of the next tick: they need no pause, and are answered at once.
//
// A pause is quiescent when every member has answered the paused frame and no robot of an edit waits for its agent.
// Edits and steps start in a quiescent pause only. Passive, as TickEngine.
//
// Why edits wait for a quiescent pause: an agent's controllers and odometry then have processed exactly the state that
// is edited, so the memory of robots after the edit does not depend on the time at which the request arrived. For the
// same reason requests never overtake each other: steps and edits form one queue, and an edit is answered only when all
// agents have answered the edited frame. A tool that waits for its reply sees the world that it asked for.
//
// An edit of a playing run pauses it, is executed, and plays on (TickEngine::play_after_edits). To a tool the run then
// appears as playing throughout.
//
// No request makes the run fail: a request that cannot be executed is answered with the reason. kMaxOpen bounds the
// open ones, because the sender may be hostile.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "world-service/service/live_run.h"
#include "world-service/service/rewind.h"
#include "world-service/service/run_observer.h"
#include "world-service/service/tick_engine.h"
#include "world-service/service/world_editor.h"

namespace troupe {

class RunControl {
 public:
  // All of them outlive the control.
  RunControl(const LiveRun& run, TickEngine& engine, WorldEditor& editor)
      : run_(run), engine_(engine), editor_(editor) {}

  // Calls `reply` once, now or in a later call. `world`: for LoadWorld and Spawn.
  void Execute(const control::Request& request, ControlReplyTo reply, RequestedWorld world, double now);
  // Replies to a request that was executed elsewhere, or failed there.
  void Reply(const ControlReplyTo& reply, const Result<std::vector<EntityReport>>& outcome) const;

  // While it runs, its owner calls Rewind::Work and then AdvanceRewind, again and again: the work is slow, and happens
  // without the lock of the run.
  Rewind& rewind() { return rewind_; }
  void AdvanceRewind(double now);

  // Replies to the requests whose pause is quiescent, and starts the next; refuses all once the run is over. Call it
  // when proposals have arrived, members were lost or the phase has changed.
  void Advance(double now);
  // Robots of the newest edit have no agent in time.
  void GiveUpNewRobots(const Error& error, double now);

 private:
  // A request without a reply.
  struct OpenRequest {
    control::Request request;
    ControlReplyTo reply;
    RequestedWorld world = {};
  };

  bool quiescent() const {
    return engine_.pause_answered() && !engine_.holding() && editor_.robots_without_agent().empty() &&
           !rewind_.is_running();
  }
  std::size_t open_requests() const { return early_.size() + queue_.size() + awaiting_pause_.size() + (edit_ ? 1 : 0); }
  // Also of a run that is continued, before its agents are back.
  bool has_begun() const { return run_.started_at || run_.continues(); }
  Status CheckRewind(const control::Rewind& rewind) const;
  bool playing() const { return !engine_.ticks_to_pause() || engine_.play_after_edits(); }
  void Pause(OpenRequest pause, double now);
  void Play(const OpenRequest& play, double now);
  void Remember(double now);
  void Enqueue(OpenRequest open, double now);
  void EnqueueStep(OpenRequest step, double now);
  void EnqueueEdit(OpenRequest edit, double now);
  void StartQueued(double now);
  void StartStep(OpenRequest step, double now);
  void StartEdit(OpenRequest edit, double now);
  void ReplyToWaiting();
  void ReplyToEdit();
  void RefuseAll(const Error& error);
  void Reply(const OpenRequest& open, const Result<std::vector<EntityReport>>& outcome) const;
  void ReplyWith(const OpenRequest& open, const Status& outcome) const;
  void Accept(const OpenRequest& open) const { Reply(open, std::vector<EntityReport>()); }
  Status SetSpeed(const std::optional<double>& speed, double now);
  Status CommandRobot(const control::CommandRobot& request, double now);
  // An input of a tick, or a command of a robot.
  void ExecuteInput(OpenRequest open, double now);
  Status AddInput(const control::Request& request, double now);
  Result<std::vector<EntityReport>> Entities(const control::Entities& query) const;
  RunState State() const;

  const LiveRun& run_;
  TickEngine& engine_;
  WorldEditor& editor_;
  std::vector<OpenRequest> early_;           // until a continued run has its agents back, or a rewind has ended
  std::deque<OpenRequest> queue_;            // steps and edits that wait for the pause before them
  std::vector<OpenRequest> awaiting_pause_;  // for a reply in the next quiescent pause
  Tick step_begun_ = 0;                      // the tick at which the step among them began
  std::optional<OpenRequest> edit_;          // applied; for a reply in the next quiescent pause
  Rewind rewind_;                            // of edit_
};

}  // namespace troupe
