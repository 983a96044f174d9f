// RunHistory: the states of a run so far, read from its recording or journal: for agents whose robots need the memory
// of them (robot_memories.h), and to set a run back (rewind.h).
//
// Positions in the past are ControllerCheckpoints: an edition, a tick, and whether the robots decided on the state or
// it was only published in a pause. Ticks alone are ambiguous, because an edit makes another state of the same tick.
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
  std::optional<ControllerCheckpoint> after = {};  // those that follow this one
  Edition from = 0;                                // without `after`: those from the first of this edition on
  bool operator==(const HistoryRequest&) const = default;
};

// A run that was set back to an earlier tick.
struct RewoundRun {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Scene> original;         // of the world that a reset restores
  FrameMessage frame;                            // the state, its hash and the editions
  std::optional<ControllerCheckpoint> previous;  // the state before it; nothing: it is the first since the fresh start
};

// The states with which a run is set back to an earlier tick: that with which the robots of that time were rebuilt,
// as the result of the request, which is an edit, then those of the steps and edits up to the tick.
class RewindStates {
 public:
  virtual ~RewindStates() = default;
  // Makes some of them from the recording, and writes nothing. False: all are made.
  virtual Result<bool> MakeSome() = 0;
  // Appends all of them to the recording, behind the newest state. After an error the recording gets no further state,
  // and its recorder ends the run. REQUIRES: all are made.
  virtual Result<RewoundRun> Write() = 0;
};

// Reads the states, which may be slow. Called on one thread at a time.
class RunHistory {
 public:
  virtual ~RunHistory() = default;
  // Some of the states, in order and without a gap, and without the newest of the run: another one follows each. Their
  // frames have no run. At least one, or an error.
  virtual Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) = 0;
  // For the last state of the request's tick. `newest`: the newest state of the run, which waits. The error is a tick
  // that the recording does not have.
  virtual Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind& request,
                                                            const FrameMessage& newest) = 0;
};

}  // namespace troupe
