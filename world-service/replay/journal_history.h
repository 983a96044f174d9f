// JournalHistory: the states of a run, stepped again from its own recording while the run continues.
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

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/service/run_history.h"

namespace troupe {

// `recordings`: those that the run writes, whose states are read from the file of the last. They outlive the history.
// Null: there are none.
std::unique_ptr<RunHistory> MakeRunHistory(const std::vector<RunRecorder*>& recordings);

class JournalHistory final : public RunHistory {
 public:
  explicit JournalHistory(const std::vector<RunRecorder*>& recordings) : recordings_(recordings) {}

  Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) override;
  Result<std::unique_ptr<RewindStates>> StartRewind(const control::Rewind& request,
                                                    const FrameMessage& newest) override;

 private:
  Status Open();
  // Goes to the state before the first entry of the answer, or to that entry.
  Status Seek(const HistoryRequest& request);
  // The tick that follows the state; null: none is in the file yet.
  Result<const RecordedTick*> Next();
  bool IsAt(const HistoryRequest& request) const { return cursor_ && request.after && request.after == sent_; }
  Status Advance();
  // Appends the state, with the tick that follows, and goes to the next.
  Status Add(std::vector<HistoryEntry>& entries);
  Result<std::vector<HistoryEntry>> ReadBatch(const HistoryRequest& request);
  // The world of the state; robots that are rebuilt later need no controller.
  WorldDescription WorldToSend() const;
  Status FindChanges();
  Error Broken(const std::string& problem) const;

  const std::vector<RunRecorder*> recordings_;
  std::unique_ptr<const Recording> recording_;
  std::optional<ReplayCursor> cursor_;
  std::map<std::string, Edition> changed_;    // by robot: when it got another controller, and was rebuilt
  std::optional<ControllerCheckpoint> sent_;  // the entry before the state; nothing: not sent
  std::shared_ptr<const Scene> sent_scene_;
};

// JournalRewind: the states of a rewind, made from the recording of the run and appended to it.
class JournalRewind final : public RewindStates {
 public:
  // Starts the rewind of a live run. `recordings`: those that the run writes, not empty; the states are read from the
  // file of the last. They outlive the rewind. The error is a tick that the recording does not have.
  static Result<std::unique_ptr<JournalRewind>> Start(const std::vector<RunRecorder*>& recordings,
                                                      const control::Rewind& request, const FrameMessage& newest);
  // The rest of a rewind within which a service died: `newest` is the newest of its states, and `next_number` that of
  // the next.
  static Result<std::unique_ptr<JournalRewind>> Finish(const std::vector<RunRecorder*>& recordings,
                                                       const UnfinishedRewind& rewind, const FrameMessage& newest,
                                                       std::uint64_t next_number);

  Result<bool> MakeSome() override;
  Result<RewoundRun> Write() override;

 private:
  enum class Stage : std::uint8_t {
    kFinding,  // the last state of the tick, and with it the edition at which its robots were made
    kSeeking,  // the first state of that edition
    kMaking,   // the states from there to the last
    kMade,
  };

  explicit JournalRewind(const std::vector<RunRecorder*>& recordings) : recordings_(recordings) {}
  Status Open();
  Error Broken(const std::string& problem) const;
  Status PlaceCursor(std::size_t chunk);
  Status Advance();
  Status Find();
  Status StartSeeking(Edition edition);
  Status Seek();
  Status Make();
  // The edit that restores the first state.
  RecordedTick FirstTick() const;
  Status WriteTo(RunRecorder& recording) const;
  // The editions of the copies follow the run's.
  Edition Shift(Edition edition) const { return std::max(edition, first_edition_) - first_edition_ + shifted_; }
  void Shift(FrameMessage& frame) const;
  FrameMessage CopiedFrame() const;

  const std::vector<RunRecorder*> recordings_;
  std::unique_ptr<const Recording> recording_;  // that is read
  Stage stage_ = Stage::kFinding;
  std::optional<ReplayCursor> cursor_;  // at the state that was made last
  control::Rewind request_;
  FrameMessage newest_;      // of the run
  std::uint64_t first_ = 0;  // the positions of the first state, and of that of the tick
  std::uint64_t last_ = 0;
  Edition first_edition_ = 0;               // of the first state, when it was recorded
  Edition shifted_ = 0;                     // of its copy
  std::size_t first_chunk_ = 0;             // from which the first state was found
  std::optional<RecordedTick> first_tick_;  // nothing: a service has written it
  std::optional<std::uint64_t> copies_;  // that follow the first state, as a service has written; nothing: it has not
  std::uint64_t written_ = 0;            // of these
  std::optional<ControllerCheckpoint> previous_;  // the state before that of the cursor
};

}  // namespace troupe
