// TickCoordinator: a run of the world service without its threads and clock. It admits agents, and passes all other
// calls to its parts: TickEngine (barrier, step, frames), WorldEditor (edits), RunControl (requests of tools) and
// RunStatistics. docs/tick-protocol.md describes its states.
//
// Passive: it acts only inside the calls below, which must be made one at a time, and knows the time only from `now`:
// wall time in s, of a clock that never decreases. So tests play whole runs, with losses and delays of messages, in a
// loop without threads and without waiting, and each failure can be repeated.
//
// After each call that may have changed the barrier, the members or the phase, RunControl::Advance follows: requests
// that waited for exactly that are answered in the same call.
//
// Any message may be lost, late, duplicated or of another run. A message of another run or incarnation has no effect,
// and none of the calls fails for what a peer has sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "world-service/service/live_run.h"
#include "world-service/service/run_control.h"
#include "world-service/service/run_service.h"
#include "world-service/service/tick_engine.h"
#include "world-service/service/world_editor.h"

namespace troupe {

// RunStatistics: the status of a run and its summary, from counters and times of the other parts.
class RunStatistics {
 public:
  // All of them outlive the statistics. `now`: wall time, s.
  RunStatistics(const LiveRun& run, const TickEngine& engine, const WorldEditor& editor, double now)
      : run_(run), engine_(engine), editor_(editor), status_at_(now) {}

  // The run begins: the first period of the real time factor, too.
  void OnBegin(double now) { status_at_ = now; }
  // The real time factor is that since the status before.
  StatusMessage MakeStatus(double now);
  RunSummary MakeSummary() const;

 private:
  std::vector<std::string> MissingRobots(double now) const;
  std::vector<SlowRobot> SlowestRobots() const;

  const LiveRun& run_;
  const TickEngine& engine_;
  const WorldEditor& editor_;
  double status_at_;  // wall time of the newest status, s
  std::uint64_t status_steps_ = 0;
};

class TickCoordinator {
 public:
  using Phase = RunPhase;

  // The endpoint and the observers outlive the coordinator. The coordinator reports every tick and world change to
  // the observers; all other reports are RunService's.
  TickCoordinator(const std::shared_ptr<const Scene>& scene, const CoordinatorOptions& options,
                  ServiceEndpoint& endpoint, RunObservers observers, double now);
  TickCoordinator(const TickCoordinator&) = delete;  // its parts refer to each other
  TickCoordinator& operator=(const TickCoordinator&) = delete;

  // Sends the session: the process of the service and its world.
  void Announce() { AnnounceSession(run_); }

  // Deliveries of the transport.
  void OnJoin(const JoinMessage& join, double now);
  // `shared`: the message itself, if it may be kept; null: it is copied.
  void OnProposal(const ProposalMessage& proposal, double now, const SharedProposal& shared = nullptr);
  void OnAgentGone(AgentId agent, double now);
  void OnAgentSilent(AgentId agent, double now);
  // The news of a launcher.
  void OnAgentNews(const AgentNews& news, double now);
  void OnRivalService(const SessionMessage& rival, double now);

  // Acts on the time that has passed; call at NextPoll(), or earlier.
  void Poll(double now);
  double NextPoll() const;
  // Calls the observers, and then as Poll.
  void Wake(double now);

  // Executes a tool's request; see RunControl.
  void Control(const control::Request& request, ControlReplyTo reply, double now, RequestedWorld world = {});
  // See RunControl.
  Rewind& rewind() { return control_.rewind(); }
  void AdvanceRewind(double now) { control_.AdvanceRewind(now); }
  void Reply(const ControlReplyTo& reply, const Result<std::vector<EntityReport>>& outcome) const {
    control_.Reply(reply, outcome);
  }

  // Agents that wait for the same states of the past.
  struct HistoryDemand {
    HistoryRequest request;
    std::optional<ControllerCheckpoint> after;  // the memory of their robots
    std::vector<AgentId> agents;
    double since = 0.0;  // wall time, s
  };
  // The demands to be answered now, each once: an agent that gets no answer joins again.
  std::vector<HistoryDemand> DrainHistoryDemands(double now);

  // Both end the run in order; after the run has ended by itself they change nothing.
  void Stop(double now);
  void Fail(Error error, double now);

  Phase phase() const { return run_.phase; }
  const FrameMessage& frame() const { return run_.frame; }
  const std::shared_ptr<const Scene>& scene() const { return run_.scene; }
  std::size_t present_agents() const { return run_.members.present_members(); }
  const Status& error() const { return run_.error; }
  // Wall time from the construction to the first frame, s, once that is sent.
  std::optional<double> startup_seconds() const;
  StatusMessage MakeStatus(double now) { return statistics_.MakeStatus(now); }
  RunSummary MakeSummary() const { return statistics_.MakeSummary(); }
  // Events, notices and robots of edits that need agents, each returned once.
  std::vector<Event> DrainEvents() { return run_.events.DrainUnreported(); }
  std::vector<std::string> DrainNotices() { return run_.notices.Drain(); }
  std::vector<std::string> DrainNewRobots() { return editor_.DrainNewRobots(); }

 private:
  void Begin(double now);
  // Every robot has an agent, or had none when the service before ended.
  bool all_have_joined() const;
  void PollGathering(double now);
  void PollRejoining(double now);
  double RejoinDeadline() const;
  void GiveUpNewRobots(double now);
  void OnOtherService(const SessionMessage& other, double now);
  void NoteGoals(const JoinMessage& join);
  void DemandHistory(const JoinMessage& join, const HistoryRequest& request, double now);
  void AnswerJoin(const JoinMessage& join, const JoinDecision& decision);

  LiveRun run_;
  TickEngine engine_;
  WorldEditor editor_;
  RunControl control_;
  RunStatistics statistics_;
  std::optional<RunId> known_rival_;
  double announced_at_ = 0.0;           // wall time of the newest session of a run that is continued, s
  std::vector<HistoryDemand> demands_;  // in the order of their arrival
  double progress_at_;                  // wall time of the newest sign, before the run begins, that agents will join, s
};

}  // namespace troupe
