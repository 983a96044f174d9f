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

// Service to agents and tools, kept for latecomers: the world, and who runs it.
struct SessionMessage {
  RunId run = 0;
  std::uint32_t protocol_version = 0;
  std::string host;
  std::uint32_t pid = 0;
  double lease_seconds = 0.0;  // an agent that is silent for longer is lost
  bool begun = false;          // the run ticks already
  WorldDescription world;
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
  bool operator==(const FrameMessage&) const = default;
};

// Agent to service: exactly one for each frame, for all robots of the agent.
struct ProposalMessage {
  RunId run = 0;
  AgentId agent = 0;
  Tick tick = 0;                     // the tick to be stepped: frame.state.tick + 1
  std::vector<Proposal> proposals;   // in robot-id order
  std::vector<std::string> reports;  // failures of controllers, for the log; usually empty
  bool held = false;                 // answers a paused frame: asks for nothing
  bool operator==(const ProposalMessage&) const = default;
};

enum class ControlCommand : std::uint8_t {
  kStatus = 0,
  kPause = 1,  // after the tick that is under way; answered when everybody holds
  kPlay = 2,
  kStep = 3,   // from a pause: `ticks` ticks, and pause again; answered when everybody holds
};

// A tool to the service: what to do with time.
struct ControlRequest {
  std::uint64_t client = 0;  // random; tells tools apart
  std::uint64_t number = 0;  // of the request, in the answer again
  ControlCommand command = ControlCommand::kStatus;
  std::uint64_t ticks = 1;   // kStep
  bool operator==(const ControlRequest&) const = default;
};

enum class RunState : std::uint8_t { kStarting = 0, kPlaying = 1, kPaused = 2, kOver = 3 };

// The service to that tool.
struct ControlReply {
  std::uint64_t client = 0;
  std::uint64_t number = 0;
  bool done = false;
  std::string problem;       // why not
  RunState state = RunState::kStarting;
  Tick tick = 0;
  std::uint64_t state_hash = 0;
  bool operator==(const ControlReply&) const = default;
};

// Service to tools, now and then: how the run goes.
struct StatusMessage {
  RunId run = 0;
  Tick tick = 0;
  std::uint64_t target_ticks = 0;        // 0: no end
  double sim_seconds = 0.0;
  double wall_seconds = 0.0;             // since the first tick
  double real_time_factor = 0.0;         // over the last period
  std::uint32_t robots = 0;
  std::uint32_t agents = 0;
  std::vector<std::string> waiting_for;  // robots whose proposals are missing for longer than a moment
  double waiting_seconds = 0.0;          // wall time that the barrier has been waiting
  bool operator==(const StatusMessage&) const = default;
};

}  // namespace troupe
