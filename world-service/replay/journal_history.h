// The past of a live run, which is stepped again from its own recording while the run continues: OwnRecording reads it,
// MakeRunHistory has its states for agents whose robots lack the memory of them, and journal_rewind.h sets the run
// back.
//
// The recording has inputs and a keyframe now and then, so a state of the past costs the steps from the keyframe before
// it. Agents ask for consecutive batches; the cursor stays behind the last entry, so that the next batch costs its own
// steps only. The file grows meanwhile: it is opened again when its known end is reached.
//
// Threads: called by the thread of RunService alone, without the lock of the run. The recorder's queue is flushed
// first, so that the file has all committed ticks.
//
// A damaged recording is an error of the run, because its robots could not be rebuilt as they were.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/service/run_history.h"

namespace troupe {

// `recorders`: of the run; the states are read from the file of the last. They outlive the history. Null: there are
// none.
std::unique_ptr<RunHistory> MakeRunHistory(const std::vector<RunRecorder*>& recorders);

// OwnRecording: the recording that a run writes, and a cursor in it. Its errors say that it cannot be read.
class OwnRecording {
 public:
  // `recorders`: not empty. The states are read from the file of the last.
  explicit OwnRecording(const std::vector<RunRecorder*>& recorders) : recorders_(recorders) {}

  const std::vector<RunRecorder*>& recorders() const { return recorders_; }
  // Reads what the file has now: all ticks of the run so far. The cursor is nowhere then.
  Status Open();
  bool is_open() const { return cursor_.has_value(); }
  // All of these: REQUIRES: is_open()
  const Recording& recording() const { return *recording_; }
  const ReplayCursor& cursor() const { return *cursor_; }
  const ReplayedWorld& world() const { return cursor_->world(); }
  // As ReplayCursor::Restart and Approach.
  Status Restart(std::size_t chunk) { return Checked(cursor_->Restart(chunk)); }
  Status Approach(std::uint64_t position) { return Checked(cursor_->Approach(position)); }
  // The tick that follows the state; null: none is in the file yet.
  Result<const RecordedTick*> Next();
  // The error is also a file that ends with the state.
  Status Advance();
  Error Broken(const std::string& problem) const;

 private:
  Status Checked(const Status& outcome) const { return outcome.ok() ? outcome : Broken(outcome.error().message); }

  const std::vector<RunRecorder*> recorders_;
  std::unique_ptr<const Recording> recording_;
  std::optional<ReplayCursor> cursor_;
};

}  // namespace troupe
