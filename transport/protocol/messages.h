// The messages between the world service, its agents and tools: plain values, independent of the transport. The files
// in idl/ define their layout on the wire; transport/dds/convert converts.
//
// What messages have in common: `run` and `incarnation` say from which run and which of its services a message is, or
// which service its sender knows; receivers drop messages of another run or an older service. `edition` orders the
// edits of a run, and a tick has a meaning only together with it. No message is sent only once that matters: each may
// be lost, late, repeated or out of order (docs/tick-protocol.md).
//
// Types with Fields() are laid out in shared memory from their lists (troupe/fields.h): the order of a list is the
// layout.
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "common/model/proposal.h"
#include "transport/protocol/control_request.h"
#include "troupe/enum_names.h"
#include "troupe/event.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"
#include "troupe/shared.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"
#include "troupe/z_range.h"

namespace troupe {

// Random, made at the start of a program; tells two runs of a session, or two agents, apart.
using RunId = std::uint64_t;
using AgentId = std::uint64_t;

// Counts the edits of a run: changes of its world from outside the simulation (reset, load, spawn, delete, set pose).
// Frames are ordered by edition, then tick.
using Edition = std::uint32_t;

// Counts the services of a run, one after the other: each that continues the run after the death of the previous one is
// the next. A message of an older service has no effect.
using Incarnation = std::uint32_t;

// Service to agents and tools, kept for latecomers: the run of a session, its service and its world.
struct SessionMessage {
  RunId run = 0;
  std::uint32_t protocol_version = 0;
  std::string host;
  std::uint32_t pid = 0;
  double lease_seconds = 0.0;  // an agent that is silent for longer is lost
  bool begun = false;          // the run ticks already
  Shared<WorldDescription> world;
  Edition world_edition = 0;  // that made this world
  Incarnation incarnation = 0;
  bool ended = false;  // the last one of a service, from its transport to that of the others: only the run counts
  bool operator==(const SessionMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"run", &SessionMessage::run},
        Field{"protocol_version", &SessionMessage::protocol_version},
        Field{"host", &SessionMessage::host},
        Field{"pid", &SessionMessage::pid},
        Field{"lease_seconds", &SessionMessage::lease_seconds},
        Field{"begun", &SessionMessage::begun},
        Field{"world", &SessionMessage::world},
        Field{"world_edition", &SessionMessage::world_edition},
        Field{"incarnation", &SessionMessage::incarnation},
        Field{"ended", &SessionMessage::ended},
    };
  }
};

// How far the memory of robots reaches: the newest state that they have processed.
struct ControllerCheckpoint {
  Edition edition = 0;
  Tick tick = 0;
  bool decided = false;  // on this state; false: it was paused
  auto operator<=>(const ControllerCheckpoint&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"edition", &ControllerCheckpoint::edition},
        Field{"tick", &ControllerCheckpoint::tick},
        Field{"decided", &ControllerCheckpoint::decided},
    };
  }
};

// Agent to service: requests the control of robots, by name. Resent until answered.
struct JoinMessage {
  RunId run = 0;
  AgentId agent = 0;
  std::uint32_t protocol_version = 0;
  std::uint64_t world_hash = 0;  // hash of the agent's description
  std::string host;
  std::uint32_t pid = 0;
  std::vector<std::string> robots;
  // All robots that the process was started for, of which its keys have the name; empty: `robots` is all of them.
  std::vector<std::string> process_robots = {};
  Edition world_edition = 0;    // of the agent's description
  Incarnation incarnation = 0;  // of the newest service that the agent knows
  // The names of the robots whose controllers accept goals.
  std::vector<std::string> accept_goals = {};
  std::optional<ControllerCheckpoint> memory = {};  // nothing: the robots are new
  bool leaving = false;  // the last one of an agent, from its transport to that of the service: only its id counts
  bool operator==(const JoinMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"agent", &JoinMessage::agent},
        Field{"run", &JoinMessage::run},
        Field{"protocol_version", &JoinMessage::protocol_version},
        Field{"world_hash", &JoinMessage::world_hash},
        Field{"host", &JoinMessage::host},
        Field{"pid", &JoinMessage::pid},
        Field{"robots", &JoinMessage::robots},
        Field{"process_robots", &JoinMessage::process_robots},
        Field{"accept_goals", &JoinMessage::accept_goals},
        Field{"world_edition", &JoinMessage::world_edition},
        Field{"incarnation", &JoinMessage::incarnation},
        Field{"memory", &JoinMessage::memory},
        Field{"leaving", &JoinMessage::leaving},
    };
  }
};

// Service to one agent: the answer to its JoinMessage.
struct AdmissionMessage {
  RunId run = 0;
  AgentId agent = 0;
  bool admitted = false;
  // The reason of a refusal. Empty when admitted, and when the agent is not admitted because it has to join again: its
  // proposal has arrived, but it is unknown (any more).
  std::string reason = {};
  // Of a refusal: those of the agent's robots that have another agent. Without them it would be admitted.
  std::vector<std::string> taken = {};
  Incarnation incarnation = 0;
  bool operator==(const AdmissionMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"agent", &AdmissionMessage::agent},       Field{"run", &AdmissionMessage::run},
        Field{"admitted", &AdmissionMessage::admitted}, Field{"reason", &AdmissionMessage::reason},
        Field{"taken", &AdmissionMessage::taken},       Field{"incarnation", &AdmissionMessage::incarnation},
    };
  }
};

// Service to agents and observers: tick n is committed. Contains the whole state, so that any single frame brings any
// replica up to date. A resent frame equals the first one, but for `last` (a run that is stopped resends its newest
// frame with it set), `holds` and `awaited`.
struct FrameMessage {
  RunId run = 0;
  WorldState state;
  std::uint64_t state_hash = 0;  // StateHash(state)
  bool last = false;             // the run is over: agents leave without an answer
  std::vector<Event> events;     // of this tick
  // The run is paused: agents publish the state (ROS 2) and answer with a paused proposal. When the run resumes, the
  // same frame is sent again without `paused`.
  bool paused = false;
  bool holds = false;  // it is paused only until nodes outside have answered the tick: the run plays
  // In a resent frame: the agents that have not answered; the others need not answer again. Empty: all are to answer.
  std::vector<AgentId> awaited;
  Edition edition = 0;
  Edition world_edition = 0;  // the session of this edition has the world that the state belongs to
  Edition fresh_edition = 0;  // the newest at which all robots started again
  Incarnation incarnation = 0;
  std::vector<RobotCommand> commands = {};  // in force for the next tick, in robot-id order; not in a paused frame
  // Robots that started again at fresh_edition need the memory of the states since. An agent without these states joins
  // again, for their history.
  bool remembered = false;
  bool operator==(const FrameMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"run", &FrameMessage::run},
        Field{"state", &FrameMessage::state},
        Field{"state_hash", &FrameMessage::state_hash},
        Field{"last", &FrameMessage::last},
        Field{"paused", &FrameMessage::paused},
        Field{"holds", &FrameMessage::holds},
        Field{"awaited", &FrameMessage::awaited},
        Field{"edition", &FrameMessage::edition},
        Field{"world_edition", &FrameMessage::world_edition},
        Field{"fresh_edition", &FrameMessage::fresh_edition},
        Field{"incarnation", &FrameMessage::incarnation},
        Field{"remembered", &FrameMessage::remembered},
        Field{"events", &FrameMessage::events},
        Field{"commands", &FrameMessage::commands},
    };
  }
};

// A state of the past.
struct HistoryEntry {
  FrameMessage frame;         // without events
  bool step_follows = false;  // false: an edit
  // The world of the frame, where it differs from the previous entry's, and in the first entry where the agents may
  // lack it.
  std::optional<WorldDescription> world = {};
  bool operator==(const HistoryEntry&) const = default;
};

// Service to agents: states of the run so far, in order and without a gap, for agents whose join says that their memory
// is behind. They process them, and join again.
struct HistoryMessage {
  RunId run = 0;
  std::vector<AgentId> agents;                     // that asked; others may use it if it follows their memory
  std::optional<ControllerCheckpoint> after = {};  // that it follows; nothing: the robots of these agents are new
  std::vector<HistoryEntry> entries;
  Incarnation incarnation = 0;
  bool operator==(const HistoryMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"run", &HistoryMessage::run},
        Field{"agents", &HistoryMessage::agents},
        Field{"after", &HistoryMessage::after},
        Field{"entries", &HistoryMessage::entries},
        Field{"incarnation", &HistoryMessage::incarnation},
    };
  }
};

// Observer to service: resend the newest frame, whole.
struct FrameRequest {
  std::uint64_t observer = 0;  // random; tells observers apart
  bool operator==(const FrameRequest&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"observer", &FrameRequest::observer},
    };
  }
};

// Agent to service: exactly one for each frame, for all robots of the agent.
struct ProposalMessage {
  RunId run = 0;
  AgentId agent = 0;
  Tick tick = 0;                     // the tick to be stepped: frame.state.tick + 1
  std::vector<Proposal> proposals;   // in robot-id order
  std::vector<std::string> reports;  // of controllers, and their failures, for the log; usually empty
  bool paused = false;               // answers a paused frame: no proposals
  Edition edition = 0;               // of the frame that it answers
  Incarnation incarnation = 0;       // of the newest service that the agent knows
  bool operator==(const ProposalMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"run", &ProposalMessage::run},         Field{"agent", &ProposalMessage::agent},
        Field{"tick", &ProposalMessage::tick},       Field{"proposals", &ProposalMessage::proposals},
        Field{"reports", &ProposalMessage::reports}, Field{"paused", &ProposalMessage::paused},
        Field{"edition", &ProposalMessage::edition}, Field{"incarnation", &ProposalMessage::incarnation},
    };
  }
};

// A message that never changes.
using SharedProposal = std::shared_ptr<const ProposalMessage>;

// Tool to service.
struct ControlRequest {
  std::uint64_t client = 0;  // random; tells tools apart
  std::uint64_t number = 0;  // of the request; repeated in the reply
  control::Request request = {};
  bool operator==(const ControlRequest&) const = default;
};

enum class RunState : std::uint8_t { kStarting = 0, kPlaying = 1, kPaused = 2, kOver = 3 };
constexpr auto NamesOf(RunState) {
  return std::array{"starting", "playing", "paused", "over"};
}

enum class EntityKind : std::uint8_t {
  kRobot = 0,
  kObject = 1,  // grippers can hold it
  kModel = 2,   // never moves
  kPerson = 3,
};
constexpr auto NamesOf(EntityKind) {
  return std::array{"robot", "object", "model", "person"};
}

constexpr ErrorCode LastOf(ErrorCode) {
  return ErrorCode::kOutputFailed;
}

// The smallest box around an entity, upright and aligned with its frame E, m. Empty: it has no body.
struct EntityBox {
  Rectangle area = {};
  ZRange z = {};
  bool operator==(const EntityBox&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"area", &EntityBox::area},
        Field{"z", &EntityBox::z},
    };
  }
};

// The agent of a robot.
struct AgentReport {
  std::string host;
  std::uint32_t pid = 0;
  bool present = false;          // false: lost
  double answer_seconds = 0.0;   // from a frame to the answer, smoothed over some ticks; 0: no answer yet
  std::uint64_t times_last = 0;  // ticks in which the robot's agent was the last to answer
  bool operator==(const AgentReport&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"host", &AgentReport::host},
        Field{"pid", &AgentReport::pid},
        Field{"present", &AgentReport::present},
        Field{"answer_seconds", &AgentReport::answer_seconds},
        Field{"times_last", &AgentReport::times_last},
    };
  }
};

// The unit of edits: a model without a parent, with its whole tree.
struct EntityReport {
  std::string name;
  std::string type;  // as in the world file
  EntityKind kind = EntityKind::kModel;
  Pose X_WE = {};
  Twist twist = {};                       // in E
  EntityBox box = {};                     // if the request asks for it
  std::optional<AgentReport> agent = {};  // of a robot that has one, or has lost it
  std::string signals = {};               // if the request names it: a line "KIND {SIGNALS}" for each row that is its
  bool operator==(const EntityReport&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &EntityReport::name},   Field{"type", &EntityReport::type},
        Field{"kind", &EntityReport::kind},   Field{"X_WE", &EntityReport::X_WE},
        Field{"twist", &EntityReport::twist}, Field{"box", &EntityReport::box},
        Field{"agent", &EntityReport::agent}, Field{"signals", &EntityReport::signals},
    };
  }
};

// Service to the tool that sent the request.
struct ControlReply {
  std::uint64_t client = 0;
  std::uint64_t number = 0;
  bool done = false;
  std::string problem;                           // reason of a refusal or failure; empty when done
  ErrorCode problem_code = ErrorCode::kFailure;  // its kind
  RunState state = RunState::kStarting;
  Tick tick = 0;
  std::uint64_t state_hash = 0;
  Edition edition = 0;
  // Other requests that have no reply yet: one whose reply was lost is perhaps among them, and must not be repeated.
  std::uint32_t open_requests = 0;
  std::vector<EntityReport> entities = {};  // of Entities; of Spawn the new one; of Spawnables name and type only
  bool operator==(const ControlReply&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"client", &ControlReply::client},
        Field{"number", &ControlReply::number},
        Field{"done", &ControlReply::done},
        Field{"problem", &ControlReply::problem},
        Field{"problem_code", &ControlReply::problem_code},
        Field{"state", &ControlReply::state},
        Field{"tick", &ControlReply::tick},
        Field{"state_hash", &ControlReply::state_hash},
        Field{"edition", &ControlReply::edition},
        Field{"open_requests", &ControlReply::open_requests},
        Field{"entities", &ControlReply::entities},
    };
  }
};

// What the service does in a tick: wall times in s, on average over about the last second; 0: no tick was made.
struct PhaseSeconds {
  double wait = 0.0;  // for proposals, and for the time of the tick
  double step = 0.0;
  double record = 0.0;  // output files and ROS messages
  double publish = 0.0;
  bool operator==(const PhaseSeconds&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"wait", &PhaseSeconds::wait},
        Field{"step", &PhaseSeconds::step},
        Field{"record", &PhaseSeconds::record},
        Field{"publish", &PhaseSeconds::publish},
    };
  }
};

// Service to tools, twice a second: the progress of the run. From its fields come the sample of idl/status.idl, and the
// JSON for the launcher and the viewer's page.
struct StatusMessage {
  RunId run = 0;
  Tick tick = 0;
  std::uint64_t target_ticks = 0;  // 0: no end
  double sim_seconds = 0.0;
  double wall_seconds = 0.0;      // since the first tick
  double real_time_factor = 0.0;  // over the last period
  std::uint32_t robots = 0;
  std::uint32_t agents = 0;
  std::vector<std::string> waiting_for;  // robots whose proposals have been missing for a while, by name
  double waiting_seconds = 0.0;          // wall time that the barrier has been waiting
  Edition edition = 0;
  Incarnation incarnation = 0;
  std::optional<double> speed = {};  // that the run is paced to, multiple of real time; none: it is not paced
  PhaseSeconds phases = {};
  bool operator==(const StatusMessage&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"run", &StatusMessage::run},
        Field{"tick", &StatusMessage::tick},
        Field{"target_ticks", &StatusMessage::target_ticks},
        Field{"sim_seconds", &StatusMessage::sim_seconds},
        Field{"wall_seconds", &StatusMessage::wall_seconds},
        Field{"real_time_factor", &StatusMessage::real_time_factor},
        Field{"robots", &StatusMessage::robots},
        Field{"agents", &StatusMessage::agents},
        Field{"waiting_for", &StatusMessage::waiting_for},
        Field{"waiting_seconds", &StatusMessage::waiting_seconds},
        Field{"edition", &StatusMessage::edition},
        Field{"incarnation", &StatusMessage::incarnation},
        Field{"speed", &StatusMessage::speed},
        Field{"phases", &StatusMessage::phases},
    };
  }
};

// The place of a committed state in its run. An edit may set the time back, so ticks alone have an order only within an
// edition.
struct StatePlace {
  Edition edition = 0;
  Tick tick = 0;
  auto operator<=>(const StatePlace&) const = default;
};

}  // namespace troupe

namespace troupe::topics {

// The names of all topics of the simulation domain, for transports and for permissions.

inline constexpr const char* kSession = "troupe/session";             // service to all
inline constexpr const char* kJoin = "troupe/join";                   // agent to service
inline constexpr const char* kAdmission = "troupe/admission";         // service to agent
inline constexpr const char* kFrame = "troupe/frame";                 // service to agents and observers
inline constexpr const char* kFrameRequest = "troupe/frame_request";  // observer to service
inline constexpr const char* kWholeFrame = "troupe/whole_frame";      // service to observers
inline constexpr const char* kHistory = "troupe/history";             // service to agents
inline constexpr const char* kProposal = "troupe/proposal";           // agent to service
inline constexpr const char* kStatus = "troupe/status";               // service to tools
inline constexpr const char* kControl = "troupe/control";             // tool to service
inline constexpr const char* kControlReply = "troupe/control_reply";  // service to tool

}  // namespace troupe::topics
