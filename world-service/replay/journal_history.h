// JournalHistory: the states of a run, stepped again from its own recording while the run continues.
#pragma once

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
  Result<std::unique_ptr<RewindStates>> StartRewind(const ControlRequest& request, const FrameMessage& newest) override;

 private:
  Status Open();
  // Goes to the state before the first entry of the answer, or to that entry.
  Status Seek(const HistoryRequest& request);
  bool IsAt(const HistoryRequest& request) const { return cursor_ && request.after && request.after == sent_; }
  Status Advance();
  // Appends the state, with the tick that follows, and goes to the next.
  Status Add(std::vector<HistoryEntry>& entries);
  Result<std::vector<HistoryEntry>> ReadBatch(const HistoryRequest& request);
  // The world of the state; robots that are made anew later need no controller.
  WorldDescription WorldToSend() const;
  Status FindChanges();
  Error Broken(const std::string& problem) const;

  const std::vector<RunRecorder*> recordings_;
  std::unique_ptr<const Recording> recording_;
  std::optional<ReplayCursor> cursor_;
  std::map<std::string, Edition> changed_;  // by robot: when it got another controller, and was made anew
  std::optional<MemoryPlace> sent_;         // the entry before the state; nothing: not sent
  std::shared_ptr<const Scene> sent_scene_;
};

}  // namespace troupe
