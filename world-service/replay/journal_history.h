// JournalHistory: the states of a run, stepped again from its own recording while the run continues.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "recording/tick_reader.h"
#include "world-service/observers/recorder/run_recorder.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/run_history.h"

namespace troupe {

class JournalHistory final : public RunHistory {
 public:
  using Append = std::function<Status(RecordedTick)>;  // to the file
  // `flush` makes all committed states readable in the file.
  JournalHistory(std::string path, std::function<Status()> flush, Append append)
      : path_(std::move(path)), flush_(std::move(flush)), append_(std::move(append)) {}

  Result<std::vector<HistoryEntry>> Read(const HistoryRequest& request) override;
  Result<RewoundRun> Rewind(const ControlRequest& request, const FrameMessage& newest) override;
  // Appends the rest of the way to a run that was restored; `next_number` is that of the next state.
  Result<RewoundRun> FinishRewind(const UnfinishedRewind& rewind, const FrameMessage& newest,
                                  std::uint64_t next_number);

 private:
  // A state of the past.
  struct Past {
    std::uint64_t number = 0;
    Edition fresh_edition = 0;
  };
  Result<Past> FindLast(Tick tick) const;
  // The way of a rewind: copies of recorded states, with later editions.
  struct Way {
    RunId run = 0;
    Edition begin = 0;         // of the first state, when it was recorded
    Edition shifted = 0;       // of its copy
    std::uint64_t copies = 0;  // states that follow the first
    Edition Shift(Edition edition) const { return std::max(edition, begin) - begin + shifted; }
  };
  FrameMessage CopiedFrame(const Way& way) const;
  // Appends the state with which the robots begin anew, that of world_, as the result of the request.
  Status AppendBegin(const ControlRequest& request, const FrameMessage& newest, const Way& way);
  // Goes the way to its end, and appends the states behind the first `made`, which were.
  Result<RewoundRun> GoWay(const Way& way, std::uint64_t made);
  Status AppendCopy(const Way& way, RecordedTick copy);
  Status Open();
  // Goes to the state before the first entry of the answer, or to that entry.
  Status Seek(const HistoryRequest& request);
  bool IsAt(const HistoryRequest& request) const { return world_ && request.after && request.after == sent_; }
  // Reads the tick that follows the state; nothing in next_: the recording ends.
  Status ReadNext();
  Status ApplyNext();
  // Appends the state, with the tick that follows, and goes to the next.
  Status Add(std::vector<HistoryEntry>& entries);
  Result<std::vector<HistoryEntry>> ReadBatch(const HistoryRequest& request);
  // The world of the state; robots that are made anew later need no controller.
  WorldDescription WorldToSend() const;
  Status FindChanges();
  Error Broken(const std::string& problem) const;

  const std::string path_;
  const std::function<Status()> flush_;
  const Append append_;
  std::unique_ptr<const Recording> recording_;
  std::optional<TickReader> reader_;
  std::optional<ReplayedWorld> world_;      // at a recorded state
  std::optional<RecordedTick> next_;        // that follows it
  std::map<std::string, Edition> changed_;  // by robot: when it got another controller, and was made anew
  std::optional<MemoryPlace> sent_;         // the entry before the state; nothing: not sent
  std::shared_ptr<const Scene> sent_scene_;
};

// Reads the recording of a run; null: it has none. `recording` outlives the history.
std::unique_ptr<JournalHistory> MakeRunHistory(RunRecorder* recording, const std::string& path);

}  // namespace troupe
