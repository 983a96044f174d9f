// Rewind: sets a run back to an earlier tick, in a quiescent pause that lasts until it is finished.
//
//   kNone --Start--> kMaking --all states are made--> kWriting --all are written--> kNone: the run is set back
//                       |                                |
//                       +--error, or the run ends        +--error--> kNone: the recorder ends the run
//                       +-----------------------> kNone: the run is as before, and so is its recording
//
// So a recording has a whole rewind or nothing of it, and a run that is stopped waits for no more than the writing.
//
// A service that dies leaves this in the journal, and the next one does:
//   kMaking                          nothing: the run is as before, and the request is unknown
//   kWriting, before the first state likewise
//   kWriting, or until the commit    RunProgress::is_rewinding, without commands and inputs, and the states so far: it
//   of the end (WorldEditor::Rewind) writes the rest and commits the end, before its agents join (resumed_run.h)
//   after the commit                 an edit like others; agents are sent the states since the robots began again
// Other requests wait from Start to the end (RunControl), so that none changes what is dropped.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "world-service/service/run_history.h"

namespace troupe {

class Rewind {
 public:
  enum class Stage : std::uint8_t {
    kNone,
    kMaking,   // the states, from the recording; nothing is written
    kWriting,  // to the recording, which nothing interrupts
  };
  Stage stage() const { return stage_; }
  bool is_running() const { return stage_ != Stage::kNone; }

  // `newest`: the state of the run. REQUIRES: is_running() is false.
  void Start(const control::Rewind& request, const FrameMessage& newest);

  // Works for some ms, or until all states are written. The only call that may be made without the lock of the run:
  // while it lasts, only stage() and is_running() may be called. REQUIRES: is_running().
  void Work(RunHistory& history);

  // The transition after Work. The outcome, with which the rewind has ended; nothing: it is still running. `run_ends`:
  // states that are not written are dropped.
  std::optional<Result<RewoundRun>> Advance(bool run_ends);

 private:
  Result<bool> MakeSome(RunHistory& history);

  Stage stage_ = Stage::kNone;
  control::Rewind request_;
  FrameMessage newest_;
  std::unique_ptr<RewindStates> states_;       // null: not started
  Result<bool> has_more_ = true;               // states to be made
  std::optional<Result<RewoundRun>> written_;  // the outcome of kWriting
};

}  // namespace troupe
