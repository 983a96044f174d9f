// RunRecorder: an observer that writes a recording of the run (docs/recording.md). A run that is faster than the disk
// waits, and loses no tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "recording/journal.h"
#include "recording/journal_tail.h"
#include "recording/mcap/byte_sink.h"
#include "recording/recording.h"
#include "troupe/result.h"
#include "world-service/observers/recorder/recording_thread.h"
#include "world-service/service/run_history.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// The first part of a recording: that of another one.
struct RecordedBegin {
  std::shared_ptr<const Recording> source;
  std::uint64_t last_number = 0;            // of its states
  std::optional<RecordedTick> change = {};  // the edit that follows them
};

struct RecordingOptions {
  std::string world_file;  // as the recording names it
  Tick keyframe_interval = kDefaultKeyframeInterval;
  std::size_t queue_bytes = RecordingThread::kQueueBytes;
  // The recording is a journal (recording/journal.h): each tick is in its tail before the agents see it.
  std::optional<JournalFiles> journal = {};
  JournalSync sync = JournalSync::kNo;
  std::shared_ptr<const RecordedBegin> begin = {};  // null: the recording begins with the run
  bool journal_is_optional = false;                 // a run whose journal cannot be written continues without it
};

class RunRecorder final : public RunObserver {
 public:
  // Creates the file. The error names it.
  static Result<std::unique_ptr<RunRecorder>> Create(const std::string& path, const RecordingOptions& options);
  RunRecorder(std::unique_ptr<mcap::ByteSink> sink, const RecordingOptions& options, std::string path = {});
  // Continues the journal of the options. The ticks of its tail are written to the recording.
  static Result<std::unique_ptr<RunRecorder>> Continue(Journal journal, const ResumedRun& resumed,
                                                       const RecordingOptions& options);

  const std::string& path() const { return path_; }  // of the file

  Status OnBegin(const RunStart& start) override;
  // The error is the first one of the file (a full disk).
  Status OnCommit(const CommittedTick& tick, const RunProgress& progress) override;
  Status OnProgress(const RunProgress& progress) override;
  Status OnTick(const CommittedTick& tick) override;
  bool IsReady() override;
  // Appends the states that `next` makes, until it returns false, as if they had followed the newest; their numbers are
  // computed here. All of them, or after an error no other state: the recording then ends, and the run that is
  // recorded, too. May wait for the disk. REQUIRES: the run commits no tick meanwhile.
  using TickSource = std::function<Result<bool>(RecordedTick&)>;
  Status Append(const TickSource& next);
  // Writes from now on; OnBegin does it, too. REQUIRES: the recorder continues a journal.
  void StartWriting() { thread_->Start(); }
  // Waits until all ticks so far can be read from the file. REQUIRES: OnBegin or StartWriting was called.
  Status Flush() { return thread_->Flush(); }
  // Writes all ticks, and closes the file.
  Status OnEnd() override;

 private:
  // What the run has committed. Ticks, progress and copies are reported on several threads: all of it is guarded by
  // mutex_.
  struct Committed {
    std::unique_ptr<JournalTail> tail = {};  // null: no journal
    std::uint64_t next_number = 0;
    RunProgress progress = {};  // the newest
    FrameMessage newest = {};   // without its state and events
    bool is_dropped = false;    // the journal: it is of no use any more
  };

  void MakeThread(RecordingWriter writer);
  // Writes the first part of the options.
  Status WriteBegin(const RecordedBegin& begin, RecordingWriter& writer);
  // All of these: REQUIRES: mutex_ is locked.
  RecordedTick Convert(const CommittedTick& tick);
  Status Write(RecordedTick tick);
  Status WriteProgress(const RunProgress& progress);
  // The outcome, unless the run continues without the journal: that is said once.
  Status Reported(const Status& outcome);

  const RecordingOptions options_;
  const std::string path_;
  std::unique_ptr<mcap::ByteSink> sink_;  // until OnBegin
  std::mutex mutex_;
  Committed committed_;
  std::optional<RecordingThread> thread_;  // from OnBegin or Continue on; last, because it uses the tail
};

}  // namespace troupe
