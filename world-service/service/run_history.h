// RunHistory: the states of a run so far, for agents whose robots need the memory of them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

// A request for states of the past.
struct HistoryRequest {
  std::optional<MemoryPlace> after = {};  // those that follow this one
  Edition from = 0;                       // without `after`: those from the first of this edition on
  bool operator==(const HistoryRequest&) const = default;
};

// A run that was set back to an earlier tick.
struct RewoundRun {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Scene> original;  // of the world that a reset restores
  FrameMessage frame;                     // the state, its hash and the editions
  std::optional<MemoryPlace> previous;    // the state before it; nothing: it is the first since the fresh start
};

class RunHistory {
 public:
  virtual ~RunHistory() = default;
  // Some of the states, in order and without a gap, and without the newest of the run: another one follows each. Their
  // frames have no run. At least one, or an error. May be slow. Called on one thread at a time.
  virtual Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) = 0;
  // Goes back to the last state of a tick, and appends the way there to the recording, behind the newest state: the
  // state with which the robots of that time were made anew, as the result of the request, which is an edit, then the
  // steps and edits up to the tick. `newest`: the newest state of the run, which waits. The error is a tick that the
  // recording does not have. May be slow; as Read.
  virtual Result<RewoundRun> Rewind(const ControlRequest& request, const FrameMessage& newest) = 0;
};

}  // namespace troupe
