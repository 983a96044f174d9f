// A recorded run: its values, the channels and schemas of a recording, and the records in CDR.
//
// What determines a run is recorded, and not its states: proposals, orders and commands of each tick, edits, and whole
// states only now and then (keyframes) as places from which to step again. The hash of each state is recorded, so that
// a program that steps it again finds a difference at once. So a recording is small, and exact.
//
// kStepVersion guards it: a program whose step gives other results refuses the recording.
//
// All parts are types in idl/, whose texts are in the file as schemas: other tools read it without Troupe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/run/run_settings.h"
#include "recording/mcap/format.h"
#include "transport/protocol/messages.h"
#include "troupe/named_expectation.h"
#include "troupe/result.h"

namespace troupe {

// A recorded run: its start, and each committed tick with all that determines it. docs/recording.md describes the file.

// The start of a run.
struct RecordedRun {
  RunId run = 0;
  std::string program_version;     // of the world service
  std::uint32_t step_version = 0;  // kStepVersion of its step
  std::string file;                // of the world, as given to the service
  Tick keyframe_interval = 0;
  RunSettings settings;
  WorldDescription world;  // with the seed
  // Of the scenario, so that the run is judged as it was meant, whatever becomes of the file.
  std::vector<NamedExpectation> expectations = {};
  std::vector<NamedRegion> regions = {};
};

// An edit that was applied.
struct RecordedEdit {
  FrameMessage before;       // of the state to which it was applied
  control::Request request;  // of kind kEdit, with the name that a spawned entity was given
  // LoadWorld: the world. Spawn: a world with only the entity to add. Delete: with the entity that a later request may
  // restore. Rewind: the world of `restored`. Else none.
  std::optional<WorldDescription> world = {};
  std::optional<WorldDescription> original = {};  // Rewind: the world that a reset restores, if it is not `world`
  std::optional<FrameMessage> restored = {};      // Rewind: the state with which the robots start again
  std::uint64_t copies = 0;  // Rewind: number of the states that follow on the way to its tick, copies of earlier ones
  Edition copied_from = 0;   // Rewind: of `restored`, when the robots began with it the first time
};

// The edit has a world in place of the previous one.
inline bool ReplacesWorld(const control::Request& request) {
  return control::Is<control::LoadWorld>(request) || control::Is<control::Rewind>(request);
}

// A committed state, with the inputs that led to it: proposals for a step, or an edit. The first has neither.
struct RecordedTick {
  std::uint64_t number = 0;  // of the committed state, from 0: ticks may be repeated or start again, after edits
  Tick tick = 0;
  Edition edition = 0;
  std::uint64_t state_hash = 0;
  std::uint64_t log_time = 0;               // ns of simulated time since the first; never decreases
  std::vector<Proposal> proposals = {};     // that entered the step, in robot-id order
  std::vector<RobotCommand> commands = {};  // from outside, that the agents had for the step
  std::vector<Input> inputs = {};           // of tools, that entered the step, in the sequence of their execution
  std::vector<Event> events = {};
  std::optional<RecordedEdit> edit = {};
  std::optional<FrameMessage> keyframe = {};  // the state, whole; at some ticks

  bool is_step() const { return number > 0 && !edit; }
};

// The parts of a recorded run as the CDR bytes of their types in idl/, and back.
//
// Any bytes are safe: an error when they are not a sample of the type, or break the contract of its IDL file.

std::vector<std::byte> RunToBytes(const RecordedRun& run);
Result<RecordedRun> RunFromBytes(std::span<const std::byte> bytes);

std::vector<std::byte> EditToBytes(const RecordedEdit& edit);
Result<RecordedEdit> EditFromBytes(std::span<const std::byte> bytes);

// The number, tick, edition, hash, events, commands and inputs.
std::vector<std::byte> TickToBytes(const RecordedTick& tick);
Status TickFromBytes(std::span<const std::byte> bytes, RecordedTick& tick);

// The channels of a recording: their topics, and the types of their messages.

inline constexpr const char* kRecordingProfile = "troupe";

enum class RecordingChannel : std::uint8_t { kRun, kProposals, kEdits, kKeyframes, kTicks };
inline constexpr std::size_t kRecordingChannels = 5;

struct ChannelType {
  const char* topic;
  const char* type;  // its name in IDL
  const char* file;  // in idl/
};

// In the order of RecordingChannel.
inline constexpr std::array<ChannelType, kRecordingChannels> kChannelTypes = {{
    {"/run", "troupe::wire::RecordedRun", "recorded_run.idl"},
    {"/proposals", "troupe::wire::Proposal", "proposal.idl"},
    {"/edits", "troupe::wire::RecordedEdit", "recorded_edit.idl"},
    {"/keyframes", "troupe::wire::Frame", "frame.idl"},
    {"/ticks", "troupe::wire::RecordedTick", "recorded_tick.idl"},
}};

// The schema of a channel: the text of its IDL file, with all types that it uses.
mcap::Schema SchemaOf(const ChannelType& channel);

// The texts of IDL files, embedded by the build. Each has the types that it uses.

struct IdlText {
  const char* file;  // in idl/
  const char* text;
};

extern const IdlText kIdlTexts[];
extern const std::size_t kIdlTextCount;

}  // namespace troupe
