// What the world service and its agents say to each other: plain values, independent of how they travel. The IDL files
// in idl/ give the same on the wire; common/dds converts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/model/event.h"
#include "common/model/proposal.h"
#include "common/model/world_description.h"
#include "common/model/world_state.h"

namespace troupe {

// Random, made at the start of a program; tells two runs of a session, or two agents, apart.
using RunId = std::uint64_t;
using AgentId = std::uint64_t;

// Counts the edits of a run: changes of its world from outside the simulation (reset, load, spawn, delete, set pose).
// Frames are ordered by edition, then tick.
using Edition = std::uint32_t;

// Service to agents and tools, kept for latecomers: the world, and who runs it.
struct SessionMessage {
  RunId run = 0;
  std::uint32_t protocol_version = 0;
  std::string host;
  std::uint32_t pid = 0;
  double lease_seconds = 0.0;  // an agent that is silent for longer is lost
  bool begun = false;          // the run ticks already
  WorldDescription world;
  Edition world_edition = 0;  // that the world came with
  bool operator==(const SessionMessage&) const = default;
};

// Agent to service: takes up robots by name. Repeated until answered.
struct JoinMessage {
  RunId run = 0;
  AgentId agent = 0;
  std::uint32_t protocol_version = 0;
  std::uint64_t world_hash = 0;  // Hash of the description that the agent works with
  std::string host;
  std::uint32_t pid = 0;
  std::vector<std::string> robots;
  Edition world_edition = 0;  // of the description that the agent works with
  bool operator==(const JoinMessage&) const = default;
};

// Service to one agent: the answer to its JoinMessage.
struct AdmissionMessage {
  RunId run = 0;
  AgentId agent = 0;
  bool admitted = false;
  std::string reason;  // why not
  bool operator==(const AdmissionMessage&) const = default;
};

// Service to all: tick n is committed. Holds the whole state, so that any single frame brings any replica up to date.
// A repeated frame is equal to the first one, but for `last` (a run that is stopped repeats its frame with it set) and
// `awaited`.
struct FrameMessage {
  RunId run = 0;
  WorldState state;
  std::uint64_t state_hash = 0;  // StateHash(state)
  bool last = false;             // the run is over: answer nothing, leave
  std::vector<Event> events;     // of this tick
  // Time stands still: show the state to those who look at the robots, and answer with a held proposal. The same frame
  // comes again without `paused` when the run goes on.
  bool paused = false;
  // Of a repeated frame: who has not answered; the others need not answer again. Empty: all are to answer.
  std::vector<AgentId> awaited;
  Edition edition = 0;
  Edition world_edition = 0;  // the session of this edition has the world that the state belongs to
  Edition fresh_edition = 0;  // the newest at which all robots were made anew, as at the start
  bool operator==(const FrameMessage&) const = default;
};

// Observer to service: send the newest frame again, whole.
struct FrameRequest {
  std::uint64_t observer = 0;  // random; tells observers apart
  bool operator==(const FrameRequest&) const = default;
};

// Agent to service: exactly one for each frame, for all robots of the agent.
struct ProposalMessage {
  RunId run = 0;
  AgentId agent = 0;
  Tick tick = 0;                     // the tick to be stepped: frame.state.tick + 1
  std::vector<Proposal> proposals;   // in robot-id order
  std::vector<std::string> reports;  // failures of controllers, for the log; usually empty
  bool paused = false;               // answers a paused frame: asks for nothing
  Edition edition = 0;               // of the frame that it answers
  bool operator==(const ProposalMessage&) const = default;
};

enum class ControlCommand : std::uint8_t {
  kStatus = 0,
  kPause = 1,  // after the tick that is under way; answered when everybody holds
  kPlay = 2,
  kStep = 3,  // from a pause: `ticks` ticks, and pause again; answered when everybody holds
  // Edits, each in a pause of its own if the run plays; answered when everybody has the edited world.
  kReset = 4,      // by `scopes`
  kLoadWorld = 5,  // the file `source`
  kSpawn = 6,      // `source`, as `name`, at `pose`
  kDelete = 7,     // `name`
  kSetPose = 8,    // of `name` to `pose`
  // Questions.
  kEntities = 9,     // the one called `name`; all if that is empty
  kSpawnables = 10,  // models of the run's world file
};
inline constexpr ControlCommand kLastControlCommand = ControlCommand::kSpawnables;

// What a reset concerns; a sum of these.
inline constexpr std::uint8_t kResetTime = 1;     // back to tick 0
inline constexpr std::uint8_t kResetState = 2;    // robots and objects as they were at first, robots begin anew
inline constexpr std::uint8_t kResetSpawned = 4;  // what was spawned goes
inline constexpr std::uint8_t kResetAll = 255;    // the world as loaded: what was deleted comes back

// A tool to the service: what to do with time, or with the world.
struct ControlRequest {
  std::uint64_t client = 0;  // random; tells tools apart
  std::uint64_t number = 0;  // of the request, in the answer again
  ControlCommand command = ControlCommand::kStatus;
  std::uint64_t ticks = 1;  // kStep
  std::string name = {};    // of an entity; spawn without one: after the source
  std::string source = {};
  Pose pose = {};  // in W
  std::uint8_t scopes = kResetAll;
  bool rename = false;  // kSpawn: take another name if this one is in use
  bool operator==(const ControlRequest&) const = default;
};

enum class RunState : std::uint8_t { kStarting = 0, kPlaying = 1, kPaused = 2, kOver = 3 };

enum class EntityKind : std::uint8_t {
  kRobot = 0,
  kObject = 1,  // grippers may take it
  kModel = 2,   // stands still
};

// What edits name: a model without a parent, with everything below it.
struct EntityReport {
  std::string name;
  std::string type;  // as in the world file
  EntityKind kind = EntityKind::kModel;
  Pose X_WE = {};
  Twist twist = {};  // in E
  bool operator==(const EntityReport&) const = default;
};

// The service to that tool.
struct ControlReply {
  std::uint64_t client = 0;
  std::uint64_t number = 0;
  bool done = false;
  std::string problem;  // why not
  RunState state = RunState::kStarting;
  Tick tick = 0;
  std::uint64_t state_hash = 0;
  Edition edition = 0;
  std::vector<EntityReport> entities = {};  // kEntities, kSpawn: the new one, kSpawnables: name and type only
  bool operator==(const ControlReply&) const = default;
};

// Service to tools, now and then: how the run goes.
struct StatusMessage {
  RunId run = 0;
  Tick tick = 0;
  std::uint64_t target_ticks = 0;  // 0: no end
  double sim_seconds = 0.0;
  double wall_seconds = 0.0;      // since the first tick
  double real_time_factor = 0.0;  // over the last period
  std::uint32_t robots = 0;
  std::uint32_t agents = 0;
  std::vector<std::string> waiting_for;  // robots whose proposals are missing for longer than a moment
  double waiting_seconds = 0.0;          // wall time that the barrier has been waiting
  Edition edition = 0;
  bool operator==(const StatusMessage&) const = default;
};

}  // namespace troupe
