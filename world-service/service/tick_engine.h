// TickEngine: advances a run tick by tick. It collects the proposals of the members, steps when the barrier is
// complete, publishes the frame, resends a frame that was not answered, and applies the settings when an agent is lost.
//
// Passive: it acts only inside the calls below, and knows the time only from `now`: wall time in s, of a clock that
// never decreases. So the call that delivers the last proposal of a tick also makes the step.
//
// Determinism: the step is a function of the state, of the proposals in robot-id order and of the inputs in the order
// of their kinds. The arrival of messages decides when it happens, and nothing else. In realtime mode the time decides
// which proposals enter, so such runs differ from each other; the code is the same but for the barrier.
//
// A tick is committed in Publish, in this order: observers write it (OnCommit), it becomes the frame of the run, the
// agents are sent it, observers follow (OnTick). If an observer cannot write it, the agents never see it: so every
// state that an agent or a tool has seen is in the journal, and a service that continues the run does not lose it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "transport/protocol/run_progress.h"
#include "transport/protocol/tick_barrier.h"
#include "world-service/core/step.h"
#include "world-service/service/live_run.h"
#include "world-service/service/tick_inputs.h"

namespace troupe {

// When the ticks before a pause are committed: at the run's speed, or without waiting for their time.
enum class Pace : bool { kRun, kAtOnce };

// The newest frame of a running run, from its publication to the next step:
//
//   kPublishing ──all agents have published──► kAwaitingRelease ──all observers have released──► kPaused or kDeciding
//   kPaused ──Resume──► kDeciding ──Commit──► the next frame
//
// A frame that no observer asks for (RunObserver::ShowsTick) is kPaused or kDeciding at once. In the first three the
// frame is `paused`: agents publish it and answer without proposals.
enum class FrameStage : std::uint8_t {
  kPublishing,       // for observers; agents have not all answered
  kAwaitingRelease,  // published; observers have not all released it
  kPaused,           // until a user resumes the run
  kDeciding,         // agents propose; the barrier opens the step
};

class TickEngine {
 public:
  // The run outlives the engine. Makes its first frame.
  TickEngine(LiveRun& run, double now);

  // The barrier waits for the member from now on.
  void AddMember(Member& member, double now);
  // `shared`: the message itself, if it may be kept; null: it is copied.
  void OnProposal(const ProposalMessage& proposal, double now, const SharedProposal& shared = nullptr);
  // The agent has ended or left. `reason`: for users.
  void OnAgentGone(AgentId agent, const std::string& reason, double now);
  // Its lease has expired. It is lost, unless a launcher knows that its process lives.
  void OnAgentSilent(AgentId agent, double now);
  // A launcher will report the end of this agent's process.
  void Supervise(AgentId agent) { supervised_.insert(agent); }

  // Publishes the first frame, or the newest of a run that is continued. REQUIRES: the phase is kGathering.
  void Begin(double now);
  // Both end the run in order; after the run has ended by itself they change nothing.
  void Stop(double now);
  void Fail(Error error, double now);

  // Time that passes, in the phases after kGathering: call both at NextPoll(), or earlier.
  void WatchSilentMembers(double now);
  // Calls the observers, which have asked for it.
  void Wake(double now);
  void Poll(double now);
  double NextPoll() const;

  // Ticks until the run pauses, 0 in a pause; nothing: no pause is planned.
  const std::optional<std::uint64_t>& ticks_to_pause() const { return ticks_to_pause_; }
  // A planned pause does not wait by default for the time of a tick: a slow run pauses as soon as a fast one.
  void SetTicksToPause(std::optional<std::uint64_t> ticks, Pace pace = Pace::kAtOnce) {
    ticks_to_pause_ = ticks;
    pace_ = ticks ? pace : Pace::kRun;
  }
  // The pause is only for edits: the run is to play after them.
  void SetPlayAfterEdits(bool plays) { play_after_edits_ = plays; }
  bool play_after_edits() const { return play_after_edits_; }
  // Tells the observers the progress of a run between two ticks.
  void ReportProgress(double now);
  // Every member has answered the paused frame.
  bool pause_answered() const { return run_.phase == RunPhase::kRunning && run_.frame.paused && barrier_.complete(); }
  // Tells observers on the network whether the paused frame only awaits observers (frame.holds), after ticks_to_pause
  // has changed: viewers show a run that waits for ROS nodes as playing.
  void ResendHold();
  // Resends the frame without `paused`, so that the agents propose; one that is awaited, as soon as it is released.
  // REQUIRES: the frame is paused, and no pause is due.
  void Resume(double now);
  // The frame is paused for the observers only, which have not released it: no pause is due.
  bool holding() const { return run_.frame.paused && ticks_to_pause_ != 0U; }
  // No observer awaits anything for the frame.
  bool released() const { return stage_ == FrameStage::kPaused || stage_ == FrameStage::kDeciding; }
  // What the frame awaits in kAwaitingRelease, for users.
  const std::vector<std::string>& awaited() const { return awaited_; }
  // A pause at the next occasion: at once if the frame is paused, else after the next tick.
  void RequestPause() { SetTicksToPause(run_.frame.paused ? 0 : 1); }

  // A multiple of real time; nothing: no pacing. REQUIRES: it is finite and positive; in realtime mode there is one.
  void SetSpeed(std::optional<double> speed, double now);
  const std::optional<double>& speed() const { return pacer_.speed(); }
  // The command is in force for `ticks` ticks from the next frame on. REQUIRES: as RobotCommands::Add.
  void AddCommand(const RobotCommand& command, std::uint64_t ticks) { commands_.Add(command, ticks); }
  // The input enters the next step, without a pause. REQUIRES: CheckInput succeeded.
  void AddInput(const Input& input) { inputs_.push_back(input); }
  std::size_t waiting_inputs() const { return inputs_.size(); }

  // The scene of the run is another one; `removed` members have no robots in it.
  void ChangeWorld(std::span<const AgentId> removed);
  // Publishes the state after an edit, in a pause: `next` is the successor of the run's frame, with its state, editions
  // and events.
  void PublishEdit(FrameMessage next, const AppliedEdit& edit, double now, bool is_recorded = false);

  // An agent is about to join: the run waits for it.
  void AwaitAgent(double now) { halted_since_ = now; }
  // A robot has no agent, and no tick can follow.
  bool halted() const;
  // The run ends with this tick.
  bool IsLast(const WorldState& state) const;
  // All observers can accept a tick.
  bool observers_ready() const;
  double observers_waited_seconds() const { return observers_waited_; }  // that ticks have waited for them
  std::vector<AgentId> MissingMembers() const { return barrier_.Missing(); }
  double committed_at() const { return committed_at_; }  // wall time of the newest frame, s
  std::uint64_t steps() const { return steps_; }
  std::uint64_t frames_resent() const { return frames_resent_; }
  // The robots that had no agent in one tick or more, and stood still.
  std::size_t frozen_robots() const { return frozen_.size(); }

 private:
  void Collect(Member& member, const ProposalMessage& message, double now, const SharedProposal& shared);
  void Report(const Member& member, std::string_view report);
  void Reject(std::string reason, double now);
  void RejectUnknown(AgentId agent, double now);
  void AskToJoin(Member& member, double now);
  void Lose(Member& member, const std::string& reason, double now);
  // Wall time, s, at which the run ends without the agents that have not left, unless one leaves before.
  double EndWithout(double now) const;

  // Tells that the first frame of the run is not answered, and fails after the start timeout.
  void AwaitFirstAnswers(double now);
  // Tells for which agents the tick waits, once in a while.
  void NoteLongWait(double now);
  // "r0, r1 and 8 more (host, pid 12; host, pid 14)": the agents that have not answered.
  std::string MissingText() const;
  void NoteFrozenRobots();
  bool observers_prepared() const;
  bool ReadyToCommit(double now);
  // When the next tick may be committed.
  double NextDue() const;
  void Commit(double now);
  // Observers ask for the frame of this tick to be shown before it is decided on.
  bool ShowsTick(Tick tick) const;
  // The stage of a frame that is published now; `shows`: an observer asks for it.
  static FrameStage StageOf(const FrameMessage& frame, bool shows);
  // In kPublishing and kAwaitingRelease: tells the observers that the agents have published the frame, asks them for
  // its release, and continues the run after it.
  void AdvanceRelease(double now);
  // Sends the paused frame without `paused`. `ends_pause`: of the run.
  void SendUnpaused(bool ends_pause, double now);
  // Publishes the newest frame of a run that is continued.
  void Continue(double now);
  // Reports the first state of a branch to the observers.
  void ReportBranch(double now);
  RunProgress Progress() const;
  void DropInvalidInputs();
  // For the answers to the frame that is sent now.
  void OpenBarrier(double now);
  void EnterPhase(TickPhase phase, Tick tick);
  // The inputs that led to a frame: of a step, or an edit.
  struct Origin {
    std::span<const Proposal> proposals = {};
    std::span<const Input> inputs = {};
    const AppliedEdit* edit = nullptr;
    bool is_recorded = false;
  };
  // Makes `next` the frame of the run. Until all observers have accepted it, the agents see nothing of it, nor of its
  // world: after a failure the run ends with the frame before.
  void Publish(FrameMessage next, const Origin& origin, double now);
  // Resends the frame as the last one.
  // `lost`: the robots that have no agent at the end of the run.
  void End(double now, const std::vector<RobotId>& lost);
  void ResendFrame();
  // The time of the next resend, unless the frame is answered before.
  double ResendDue() const;

  LiveRun& run_;
  std::unique_ptr<Stepper> stepper_;  // of the run's scene
  TickBarrier barrier_;
  ProposalCollector proposals_;
  RobotCommands commands_;
  std::vector<Input> inputs_;  // of the next step, in the sequence of their arrival
  Pacer pacer_;
  bool speed_is_set_ = false;  // during the run
  PaceWatch pace_watch_;
  ResendTimer resend_timer_;
  // The first answers to a frame of this service: until they are complete a silent agent is not lost, but reported.
  enum class FirstAnswers : std::uint8_t { kAwaited, kReportedMissing, kComplete };
  FirstAnswers first_answers_ = FirstAnswers::kAwaited;
  bool play_after_edits_ = false;
  std::optional<std::uint64_t> ticks_to_pause_;
  Pace pace_ = Pace::kRun;
  FrameStage stage_ = FrameStage::kDeciding;  // of the run's frame
  std::vector<std::string> awaited_;
  std::uint64_t steps_ = 0;
  std::uint64_t frames_resent_ = 0;
  double observers_waited_ = 0.0;  // s
  std::optional<double> observers_wait_since_;
  std::set<AgentId> supervised_;      // whose end a launcher reports
  std::set<std::string> frozen_;      // names of robots
  bool has_new_losses_ = true;        // since frozen_ was complete
  bool has_changed_members_ = false;  // in a pause, in which no tick tells the journal

  // Wall times, s.
  double committed_at_ = 0.0;       // of the newest frame
  double arrived_at_ = 0.0;         // of the newest answer of a member, or the frame
  double resent_at_ = 0.0;          // when a frame was resent
  double halted_since_ = 0.0;       // since no agent is left
  std::optional<double> noted_at_;  // of the newest notice of a long wait
  double end_at_ = 0.0;             // when the last frame need not be resent any more
};

}  // namespace troupe
