// AgentProtocol: an agent's side of the tick protocol, without its threads and clock. It joins a run, answers each
// frame with one proposal message, joins again after it was lost, and ends with the run. docs/tick-protocol.md
// describes it.
//
// Passive: it acts only inside the calls below, which must be made one at a time, and knows the time only from `now`:
// wall time in s, of a clock that never decreases. It answers a frame inside OnFrame. The replica is made and changed
// by tasks that the caller performs between BeginTask and FinishTask, in which all other calls may be made.
//
// Its states, and what leads from one to the next; any other message leaves the state as it is:
//   Waiting    a session                                         Preparing
//              none within the session timeout                   Ended, failed
//   Preparing  the replica is made                               Joining
//              none of the robots is in the world any more       Ended
//   Joining    the admission                                     Running
//              a history that follows the memory of the robots   Retracing
//              a refusal, as others have some of the robots      Changing, to leave them
//              another refusal                                   Ended, failed
//              none of the robots is in the world any more       Ended
//   Retracing  the robots have processed the history             Joining
//   Running    a frame of an edited world or of a fresh start    Changing
//              a frame that needs memory that the robots lack    Joining
//              the agent is unknown, the service is lost, or     Joining
//              another one continues the run
//   Changing   the replica is changed                            Running, or Joining after a loss or a refusal
//              none of the robots is left                        Ended
//   before the first admission
//              another session, or a newer world of it           Preparing
//              the service is gone or lost                       Waiting
//   after it   the service has ended in order                    Ended
//              a lost service has not returned in time           Ended, failed
//   any        the last frame of the run                         Ended
//              a task or an answer fails                         Ended, failed
//
// Determinism: an answer is computed from a frame, the robots' memory and nothing else, so that a resent frame gets the
// same answer (AnswerAgain), and robots that are made again from a history (Retracing) decide as the lost ones would
// have. Wall time decides only when joins are sent and when the agent gives up.
//
// Frames that cannot be answered yet are kept, the newest one only: any frame has the whole state.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "robot-agent/agent/agent_host.h"
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
  // `is_checked`: as AgentHandler::OnCheckedFrame.
  void OnFrame(const FrameMessage& frame, double now, bool is_checked = false);
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
  void Fail(Error error) { state_ = Ended{std::move(error)}; }

  // The agent has ended: by the end of its run, or by failure().
  bool over() const { return Is<Ended>(); }
  Status failure() const { return over() ? std::get<Ended>(state_).failure : Status(); }
  // The agent is a member of its run, and answers frames.
  bool is_running() const { return Is<Running>(); }
  // The names of its robots. REQUIRES: is_running()
  std::vector<std::string> RobotNames() const { return robots_.replica->RobotNames(); }
  // Lines for the terminal, each returned once.
  std::vector<std::string> DrainNotices() { return std::exchange(notices_, {}); }

 private:
  static constexpr double kFirstJoinPeriod = 0.1;  // s; from a join without an answer to the next one

  // For a task; null: it has begun.
  using Work = std::unique_ptr<ReplicaTask::Work>;
  struct Waiting {
    double until;  // time
  };
  struct Preparing {
    Work work;
  };
  struct Joining {
    std::optional<double> sent_at = {};  // the newest join; nothing: it is to be sent
    double period = kFirstJoinPeriod;    // until the run has begun
  };
  struct Retracing {
    Work work;
  };
  struct Running {};
  struct Changing {
    Work work;
    bool rejoins = false;  // the agent is no longer a member, and has to join again
  };
  struct Ended {
    Status failure = {};  // ok: the service ended the run, or the agent has no robots left
  };
  // The states are a variant, so that data of one state cannot be read in another.
  template <typename State>
  bool Is() const {
    return std::holds_alternative<State>(state_);
  }

  // The order of frames: a tick that pauses has a paused frame first, then one to be answered with proposals.
  using FramePlace = std::tuple<Edition, Tick, bool>;
  static FramePlace PlaceOf(const FrameMessage& frame) { return {frame.edition, frame.state.tick, !frame.paused}; }

  // The agent's knowledge of the run that it has chosen.
  struct Run {
    RunId id = 0;
    Incarnation incarnation = 0;             // the highest
    Edition newest_world = 0;                // the highest that the service has announced
    bool has_begun = false;                  // a frame of it has arrived
    bool was_member = false;                 // the service has admitted this agent
    bool notes_return = false;               // the next admission is a notice
    std::optional<double> service_lost_at;   // when its lease expired; nothing: it has returned since
    std::unique_ptr<SessionMessage> edited;  // with the world of frames to come; null: the replica has the newest world
    std::uint64_t edited_hash = 0;           // of that world; 0: not computed yet
    std::optional<Edition> asked_memory_of;  // the fresh start since which the agent has asked for a history
    std::optional<FrameMessage> kept_frame;  // the newest one that cannot be answered yet
    std::optional<FramePlace> bad_frame;     // the newest that was ignored because of its state
    std::optional<FramePlace> answered;      // of the frame that `answer` answers
    SharedProposal answer;                   // null: no frame was answered
    SharedProposal earlier_answer;           // whose memory the next one reuses, if it has no other user
    std::optional<WorldState> paused_state;  // of that frame, if it is paused and a gateway shows it
    double received_at = 0.0;                // when the newest frame arrived
    double repeated_at = 0.0;                // when the gateway was asked to repeat a tick
  };

  void WaitForSession(double now);
  // Prepares for a session before the admission.
  void Choose(const SessionMessage& session);
  // False for a message of the run from an earlier service than the newest. The first message of a later one makes the
  // agent join again.
  bool IsCurrent(Incarnation incarnation);
  // The run of which the agent was a member has to admit it again.
  void Rejoin();
  // Leaves the robots that others have to them, or ends the agent.
  void OnRefusal(const AdmissionMessage& admission);
  double GiveUpAt() const;  // time, unless the lost service returns
  double NextJoin() const;
  double NextRepeat() const;
  JoinMessage MakeJoin();

  // Applies the result of a history: the world of the replica may be another one.
  void FinishRetracing(ReplicaTask::Retracing& past);
  // Answers a frame in the state Running, or begins to change the replica if an edit came before the frame.
  void Process(const FrameMessage& frame, bool is_checked);
  void ProcessKept();
  // Keeps a frame that cannot be answered yet, unless a newer one is kept.
  void Keep(const FrameMessage& frame);
  void AnswerNew(const FrameMessage& frame, bool is_checked);
  void AnswerAgain(const FrameMessage& frame);
  void SendAnswer(Tick next);
  // The memory of an answer that is no longer in use.
  std::vector<Proposal> TakeUnusedProposals();
  void WriteTrace(Tick next);
  // Computes the answer to a new frame; false if the frame cannot be answered.
  bool ComputeAnswer(const FrameMessage& frame, bool is_checked);
  // The robots lack the memory that the frame demands, and their history was not asked for yet.
  bool LacksMemory(const FrameMessage& frame) const;

  AgentEndpoint& endpoint_;
  const AgentOptions& options_;
  const AgentResources resources_;
  std::variant<Waiting, Preparing, Joining, Retracing, Running, Changing, Ended> state_;
  Run run_;             // from Preparing on
  AgentRobots robots_;  // from Joining on, but for a task
  std::vector<std::string> notices_;
};

}  // namespace troupe
