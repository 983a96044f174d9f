// PageRequest: a request of the page, as JSON text.
// - {"type": "select", "robots": ["r0", "r1"]}, or "robots": "all": whose readings the page shows; with "pictures":
//   "r0" the images of that robot's cameras are among them; with "traffic": true updates have the next moves and the
//   waits of robots on lanes
// - {"type": "control", "id": 7, "command": "set_pose", "name": "r0", "pose": [x, y, z, heading]}
// - {"type": "control", "id": 8, "command": "spawn", "source": "scout", "controller": "wander", "pose": [x, y, z,
//   heading]}: without a controller the robot has that of the model
// - {"type": "control", "id": 8, "command": "speed", "speed": 2.5}, or "speed": "max"
// - {"type": "control", "id": 9, "command": "rewind", "tick": 120}
// - {"type": "control", "id": 9, "command": "entities", "name": "r0"}: without a name all of them
// - {"type": "control", "id": 9, "command": "command_robot", "name": "r0", "ticks": 5, "twist": [vx, vy, wz],
//   "grippers": [{"gripper": 0, "opening": percent, "lift": percent}], "goal": {"waypoints": [[x, y], ...], "heading":
//   h}}: each part may be missing, as may opening, lift and heading; a goal without waypoints cancels the goal
// - {"type": "control", "id": 9, "command": "door", "name": "gate", "opening": 1}: from 0, closed, to 1
// - {"type": "control", "id": 9, "command": "light", "name": "r0.beacon", "on": true}
// - {"type": "seek", "position": 12} or {"type": "seek", "tick": 120}: shows a past state, until {"type": "live"}
// - {"type": "series", "id": 11, "signals": [["r0", "x"], ...], "from": 0, "to": 500, "every": 1}: of signals
//   (signals.h) between two positions; without signals the reply names all that exist
// - {"type": "totals", "id": 12}: of robots (past_answers.h); {"type": "expectations", "id": 14}: their verdicts
//   (expectation_rows.h)
// - {"type": "run_again", "id": 13, "seed": 5}: starts a run that is over again; without a seed with its own. A page
//   that runs its scenario itself starts it at any time, and with other values: "values": [["spawn[0].count", 20], ...]
// - {"type": "edit", "id": 10, "op": "rename", ...}: of the page of an editor (edit_operation.h)
//
// The commands are listed in page_request.cc: those of `troupe ctl` that name no files. A text that is no request
// closes the connection: the page sends none, so its sender is another program. A request of the right form with a
// wrong value is answered with the error. Numbers must be finite, lists are bounded; ids are chosen by the page, and
// repeated in the reply.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "viewer/gateway/edit_operation.h"
#include "viewer/gateway/signals.h"

namespace troupe {

inline constexpr std::size_t kMaxPageRequest = 8192;       // bytes
inline constexpr std::size_t kMaxEditRequest = 1'000'000;  // bytes, of the page of an editor
inline constexpr std::size_t kMaxSelected = 64;            // robots by name

// The robots whose readings are measured for this viewer; each measurement costs as much as in the agent.
struct SelectRequest {
  bool all = false;
  std::vector<std::string> robots;
  std::string pictures = {};  // the robot whose camera images the page shows; empty: none
  bool traffic = false;       // the page shows the traffic of robots on lanes
  bool operator==(const SelectRequest&) const = default;
};

// A request to the service. The reply has the same id.
struct PageControl {
  std::uint64_t id = 0;  // repeated in the reply
  control::Request request;
  bool operator==(const PageControl&) const = default;
};

// One of both. A tick is that of the newest edition that has it.
struct SeekRequest {
  std::optional<std::uint64_t> position;
  std::optional<Tick> tick;
  bool operator==(const SeekRequest&) const = default;
};

// Ends the showing of a past state.
struct LiveRequest {
  bool operator==(const LiveRequest&) const = default;
};

struct PageEdit {
  std::uint64_t id = 0;             // repeated in the reply
  Result<EditOperation> operation;  // the error is for the reply
};

inline constexpr std::size_t kMaxSignals = 32;

// Values of signals at the positions from, from + every, ... up to `to`.
struct SeriesRequest {
  std::uint64_t id = 0;  // repeated in the reply
  std::vector<SignalName> signals;
  std::uint64_t from = 0;  // positions
  std::uint64_t to = 0;
  std::uint64_t every = 1;
  bool operator==(const SeriesRequest&) const = default;
};

// The sums over the whole past.
struct TotalsRequest {
  std::uint64_t id = 0;  // repeated in the reply
  bool operator==(const TotalsRequest&) const = default;
};

// The verdicts over the past so far.
struct ExpectationsRequest {
  std::uint64_t id = 0;  // repeated in the reply
  bool operator==(const ExpectationsRequest&) const = default;
};

// What a vehicle of VDA 5050 had sent as its newest state.
struct VehicleRequest {
  std::uint64_t id = 0;  // repeated in the reply
  std::string robot;
  std::uint64_t position = 0;
  bool operator==(const VehicleRequest&) const = default;
};

// Values are for pages that run their scenario themselves.
struct RunAgainRequest {
  std::uint64_t id = 0;  // repeated in the reply
  std::optional<std::uint64_t> seed = {};
  // Of the scenario, by their paths (testing/cases/value_path.h), as JSON; nothing: as in the previous run.
  std::optional<std::vector<std::pair<std::string, std::string>>> values = {};
  bool operator==(const RunAgainRequest&) const = default;
};

using PageRequest = std::variant<SelectRequest, PageControl, SeekRequest, LiveRequest, PageEdit, SeriesRequest,
                                 TotalsRequest, ExpectationsRequest, VehicleRequest, RunAgainRequest>;

// The error is of the page, or of a stranger: it is not a request. `longest`: bytes of an edit; others are shorter.
Result<PageRequest> ParsePageRequest(std::string_view text, std::size_t longest = kMaxPageRequest);

// The same for a service of Foxglove: `json` has the members of a command but for "type", "id" and "command".
Result<PageControl> ParseControl(std::uint64_t id, const std::string& command, std::string_view json);

// `text` is made where the answer is known, since only that place knows its members.
struct PageReply {
  std::uint64_t id = 0;
  bool done = false;
  std::string problem;
  std::string text;         // the whole reply as JSON, for the page
  bool has_totals = false;  // of the whole past
};
// JSON has no infinite numbers.
nlohmann::json NumberOrNull(double value);

// Of the answer to one question about the past: seeks wait for it.
inline constexpr auto kMaxPastAnswer = std::chrono::milliseconds(40);

PageReply ReplyToControl(std::uint64_t id, const Result<ControlReply>& reply);
// The members of the object, if there is one, become members of the reply.
PageReply ReplyToEdit(std::uint64_t id, const Result<nlohmann::json>& reply);

}  // namespace troupe
