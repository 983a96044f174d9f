// AgentProtocol: an agent's side of the tick protocol, without its threads and clock. It joins a run, answers each
// frame with one proposal message, joins again after it was lost, and ends with the run. docs/tick-protocol.md
// describes it.
//
// Passive: it acts only inside the calls below, which must be made one at a time, and knows the time only from `now`:
// wall time in s, of a clock that never decreases. It answers a frame inside OnFrame. The replica is made and changed
// by tasks that the caller performs between BeginTask and FinishTask, in which all other calls may be made.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "robot-agent/agent/agent_options.h"
#include "robot-agent/agent/replica.h"
#include "robot-agent/agent/replica_task.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe {

class AgentProtocol {
 public:
  // All of them outlive the protocol. It only sends proposals through the endpoint.
  AgentProtocol(AgentEndpoint& endpoint, const AgentOptions& options, const AgentResources& resources, double now);

  // Deliveries of the transport.
  void OnSession(const SessionMessage& session);
  void OnAdmission(const AdmissionMessage& admission);
  void OnFrame(const FrameMessage& frame, double now);
  void OnHistory(const HistoryMessage& history);
  void OnServiceGone(double now);
  void OnServiceLost(double now);

  // Acts on the time that has passed; call at NextPoll(), or earlier. Returns the join that the caller is to send.
  std::optional<JoinMessage> Poll(double now);
  double NextPoll() const;

  // A task that the caller is to perform; nothing: there is none. FinishTask applies its results, but for a replica of
  // no use, which remains in the task.
  bool has_task() const;
  std::optional<ReplicaTask> BeginTask();
  void FinishTask(ReplicaTask& task);

  // Ends the agent.
  void Fail(Error error);

  // The agent has ended: by the end of its run, or by failure().
  bool over() const { return stage_ == Stage::kRunOver || stage_ == Stage::kFailed; }
  const Status& failure() const { return failure_; }
  // The agent is a member of its run, and answers frames.
  bool is_running() const { return stage_ == Stage::kRunning; }
  // The names of its robots. REQUIRES: is_running()
  std::vector<std::string> RobotNames() const { return replica_->RobotNames(); }
  // Lines for people, each returned once.
  std::vector<std::string> DrainNotices() { return std::exchange(notices_, {}); }

 private:
  // Messages of another stage change nothing.
  enum class Stage : std::uint8_t {
    kWaiting,    // for a session
    kPreparing,  // the replica for run_ is to be made
    kJoining,    // joins are sent: for the first time, or again
    kRetracing,  // the robots are to process history_, then joins are sent again
    kRunning,    // admitted: frames are answered
    kChanging,   // admitted: the replica is to be changed as change_ says
    kRunOver,    // the service ended the run, or all robots were removed
    kFailed,     // by failure_
  };
  // The order of frames: a tick that pauses has a paused frame first, then one to be answered with proposals.
  using FramePlace = std::tuple<Edition, Tick, bool>;
  static FramePlace PlaceOf(const FrameMessage& frame) { return {frame.edition, frame.state.tick, !frame.paused}; }

  bool is_admitted() const { return stage_ == Stage::kRunning || stage_ == Stage::kChanging; }
  // The service has admitted this agent to run_ at some time.
  bool was_admitted() const { return is_admitted() || was_lost_; }
  // Of a message of the run: false if it is of an earlier service than the newest. The first message of a later one
  // makes the agent join again.
  bool IsCurrent(Incarnation incarnation);
  void WaitForSession(double now);
  // Prepares for a session before the admission.
  void Choose(const SessionMessage& session);
  void StartJoining();
  // The run of which the agent was a member has to admit it again.
  void Rejoin();
  double GiveUpAt() const;  // time, unless the lost service returns
  double NextJoin() const;
  double NextRepeat() const;
  JoinMessage MakeJoin();
  // Answers a frame in the stage kRunning, or begins the stage kChanging if an edit came before the frame.
  void Process(const FrameMessage& frame);
  void ProcessKept();
  // Keeps a frame that cannot be answered yet, unless a newer one is kept.
  void Keep(const FrameMessage& frame);
  void BeginChange(const FrameMessage& frame, bool fresh);
  void Answer(const FrameMessage& frame);
  // Computes answer_ for a new frame; false if the frame cannot be answered.
  bool ComputeAnswer(const FrameMessage& frame);
  void FinishMaking(ReplicaTask& task);
  void FinishChange(ReplicaTask& task);
  void FinishRetracing(ReplicaTask& task);
  // The robots lack the memory that the frame demands, and their history was not asked for yet.
  bool LacksMemory(const FrameMessage& frame) const;

  AgentEndpoint& endpoint_;
  const AgentOptions& options_;
  const AgentResources resources_;
  Stage stage_ = Stage::kWaiting;
  double waiting_until_ = 0.0;               // for a session
  std::unique_ptr<SessionMessage> session_;  // arrived, and not yet used
  std::uint64_t session_hash_ = 0;           // of its world; 0: not computed yet
  RunId run_ = 0;                            // from preparing on
  Incarnation incarnation_ = 0;              // the highest of the run
  std::unique_ptr<Replica> replica_;         // from joining on, but for a task
  std::uint64_t world_hash_ = 0;             // of the replica's world
  Edition world_edition_ = 0;                // of the replica, or of change_
  ReplicaTask change_;                       // in the stage kChanging
  std::unique_ptr<HistoryMessage> history_;  // in the stage kRetracing, until its task begins
  std::vector<std::string> robots_;          // of the agent, from joining on
  std::optional<MemoryPlace> memory_;        // of the robots
  std::optional<Edition> remembered_;        // the fresh edition whose history the agent has asked for
  bool log_is_marked_ = false;               // the scan log has the edition of the robots
  double joined_at_ = 0.0;                   // the newest join
  double join_period_ = 0.0;
  bool run_has_begun_ = false;              // a frame of it has arrived
  bool was_lost_ = false;                   // since it was admitted; it has to join again
  bool tells_return_ = false;               // its next admission is a notice
  std::optional<double> service_lost_at_;   // when its lease expired; nothing: it has returned since
  std::optional<Edition> fresh_edition_;    // the edition that its robots started at; nothing: no frame was answered
  std::optional<FrameMessage> kept_frame_;  // the newest one that cannot be answered yet
  std::optional<FramePlace> answered_;      // of the frame that answer_ answers
  ProposalMessage answer_;
  std::optional<WorldState> paused_state_;  // of the answered frame, if it is paused and a gateway shows it
  double repeated_at_ = 0.0;                // when the gateway was asked to repeat a tick
  Status failure_;
  std::vector<std::string> notices_;
};

}  // namespace troupe
