// TickCoordinator: drives a run. It admits agents, publishes frames, collects proposals, steps when all are there,
// repeats a frame that somebody missed, and does what the settings say when an agent is lost. docs/tick-protocol.md has
// its states and what it does in each.
//
// Passive: it acts only inside the calls below, which must come one at a time, and knows the time only from `now`: wall
// time in s, of a clock that never goes back. So whoever delivers the last proposal of a tick also makes the step.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/tick_barrier.h"
#include "common/protocol/transport.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/trace/tick_trace.h"
#include "common/worldfile/load_world.h"
#include "world-service/core/edit_world.h"
#include "world-service/service/event_log.h"
#include "world-service/service/membership.h"
#include "world-service/service/pacer.h"
#include "world-service/service/proposal_collector.h"
#include "world-service/service/recorder.h"
#include "world-service/service/repeat_timer.h"
#include "world-service/service/run_summary.h"
#include "world-service/service/world_control.h"
#include "world-service/service/world_gateway.h"

namespace troupe {

struct CoordinatorOptions {
  RunSettings settings;
  RunId run = 0;  // random; of two services that gather agents in one session, the one with the lower id stays
  double lease_seconds = 2.0;
  double start_timeout_seconds = 60.0;  // for all robots to join; 0: wait for ever
  bool start_paused = false;            // at tick 0
  TraceLane* trace = nullptr;           // outlives the coordinator; null: none
  std::string host;                     // of this process, for the session
  std::uint32_t pid = 0;
};

// What was read from files for a request: the world to load, or the one whose only entity is to be spawned.
using RequestedWorld = std::shared_ptr<const WorldDescription>;

class TickCoordinator {
 public:
  enum class Phase : std::uint8_t {
    kGathering,  // waiting for an agent for every robot
    kRunning,    // ticking
    kEnding,     // the last frame is out; waiting for the agents to leave
    kOver,
  };

  // Scene, endpoint, recorder and gateway must outlive the coordinator. The recorder and the gateway, which may be
  // null, get every frame.
  TickCoordinator(const Scene& scene, const CoordinatorOptions& options, ServiceEndpoint& endpoint, Recorder& recorder,
                  double now, WorldGateway* gateway = nullptr);

  // Sends the session: who runs it, and its world.
  void Announce();

  // What arrives from the transport.
  void OnJoin(const JoinMessage& join, double now);
  void OnProposal(const ProposalMessage& proposal, double now);
  void OnAgentGone(AgentId agent, double now);
  void OnRivalService(const SessionMessage& rival, double now);

  // Does what is due by time; call at NextPoll(), or earlier.
  void Poll(double now);
  double NextPoll() const;

  // What a tool asks for. `reply` is called once, from here or from a later call. `world`: for kLoadWorld and kSpawn.
  void Control(const ControlRequest& request, ControlReplyTo reply, double now, RequestedWorld world = nullptr);
  // Answer a request that others have dealt with, or that came to nothing before it got here.
  void Reply(const ControlRequest& request, const ControlReplyTo& reply, std::vector<EntityReport> entities) const;
  void Refuse(const ControlRequest& request, const ControlReplyTo& reply, const std::string& problem) const;

  // Both end the run in order; after the run has ended by itself they change nothing.
  void Stop(double now);
  void Fail(Error error, double now);

  Phase phase() const { return phase_; }
  const FrameMessage& frame() const { return frame_; }
  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  std::size_t present_agents() const { return members_.present_members(); }
  const Status& error() const { return error_; }
  // From the beginning to the first frame, once that is out.
  std::optional<double> startup_seconds() const {
    return started_at_ ? std::optional(*started_at_ - created_at_) : std::nullopt;
  }
  StatusMessage MakeStatus(double now);
  RunSummary MakeSummary() const;
  // Events and notices that were not returned before.
  std::vector<Event> TakeEvents() { return events_.TakeUntold(); }
  std::vector<std::string> TakeNotices();
  // Robots that an edit has brought, for which agents have to be started.
  std::vector<std::string> TakeNewRobots();

 private:
  Tick next_tick() const { return frame_.state.tick + 1; }
  bool realtime() const { return options_.settings.mode == Mode::kRealtime; }
  // A robot has no agent, and so nothing goes on.
  bool halted() const;
  bool ReadyToCommit(double now) const;

  // A request that is not yet answered.
  struct OpenRequest {
    ControlRequest request;
    ControlReplyTo reply;
    RequestedWorld world = nullptr;
  };

  void RepeatFrame();
  void Begin(double now);
  void Commit(double now);
  void Publish(double now);
  void End(double now);

  // Everybody holds a paused frame, and nobody is on the way.
  bool settled() const {
    return phase_ == Phase::kRunning && frame_.paused && barrier_.complete() && newcomers_.empty();
  }
  bool playing() const { return !ticks_to_pause_ || play_after_edits_; }
  void Settle(double now);
  void AnswerPaused();
  void Resume(double now);
  void Play(const OpenRequest& open, double now);
  // Does what waits for the pause that has settled.
  void Proceed(double now);
  void StartStep(OpenRequest step, double now);
  void AskForEdit(OpenRequest open, double now);
  Result<EditedWorld> Carry(OpenRequest& edit) const;
  void StartEdit(OpenRequest edit, double now);
  void TakeOver(EditedWorld edited, double now);
  void ChangeWorld(std::shared_ptr<const Scene> scene, bool fresh);
  void GiveUpNewcomers(double now);
  // Takes back a spawn whose robot has no agent.
  void Unspawn(const std::string& name, double now);
  void Note(const ControlRequest& request);
  void Answer(const OpenRequest& open, const std::string& problem, std::vector<EntityReport> entities = {}) const;
  void AnswerEntities(const OpenRequest& open) const;
  void AnswerEdit(const OpenRequest& edit) const;
  void AnswerAll(const std::string& problem);

  void Answer(const JoinMessage& join, bool admitted, const std::string& reason);
  void TakeUp(Member& member, double now);
  void TakeProposals(Member& member, const ProposalMessage& message, double now);
  void Lose(Member& member, const std::string& why, double now);
  void LoseSilentMembers(double now);
  void Reject(std::string reason, double now);
  std::vector<std::string> MissingRobots(double now) const;
  std::string ListNames(const std::vector<RobotId>& robots) const;

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Scene> original_;  // of the world as loaded
  BodyIndex bodies_;                       // of scene_: the steps' own
  const CoordinatorOptions options_;
  ServiceEndpoint& endpoint_;
  Recorder& recorder_;
  WorldGateway* const gateway_;

  Phase phase_ = Phase::kGathering;
  Status error_;
  bool interrupted_ = false;
  FrameMessage frame_;  // the newest; before the first tick, the one to begin with

  // Ticks until the run pauses, 0 in a pause; nothing: no pause is in sight.
  std::optional<std::uint64_t> ticks_to_pause_;
  std::deque<OpenRequest> queue_;            // steps and edits that wait for the pause before them
  std::vector<OpenRequest> awaiting_pause_;  // answered when everybody holds
  Tick step_begun_ = 0;                      // the tick at which the step among them began
  std::optional<OpenRequest> edit_;          // carried out; likewise
  bool play_after_edits_ = false;            // the pause is only for them
  std::vector<RobotId> newcomers_;           // that an edit has brought, and that have no agent yet
  double newcomers_since_ = 0.0;
  std::vector<std::string> new_robots_;  // not yet told

  Membership members_;
  TickBarrier barrier_;
  ProposalCollector proposals_;
  EventLog events_;
  // A hostile peer may cause any number between two calls of TakeNotices.
  static constexpr std::size_t kNoticesKept = 100;
  std::vector<std::string> notices_;
  Pacer pacer_;
  RepeatTimer repeat_timer_;
  std::uint64_t frames_repeated_ = 0;
  std::uint64_t steps_made_ = 0;
  std::vector<std::string> lost_at_end_;
  std::optional<RunId> known_rival_;

  // Wall times.
  const double created_at_;
  std::optional<double> started_at_;  // frame 0, once it is out
  double committed_at_ = 0.0;         // of the newest frame
  double arrived_at_ = 0.0;           // of the newest answer, or the frame
  double halted_since_ = 0.0;         // since nobody was left to go on
  double end_at_ = 0.0;               // when the last frame need not be repeated any more
  // When the last status was made, and after how many steps.
  double status_at_ = 0.0;
  std::uint64_t status_steps_ = 0;
};

}  // namespace troupe
