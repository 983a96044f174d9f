// RunRecorder: an observer that writes a recording of the run (docs/recording.md). A thread of its own writes, behind a
// bounded queue; a run that is faster than the disk waits, and loses no tick.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "recording/journal.h"
#include "recording/journal_tail.h"
#include "recording/mcap/byte_sink.h"
#include "recording/recording.h"
#include "recording/recording_writer.h"
#include "troupe/result.h"
#include "world-service/observers/recorder/tick_queue.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// The begin of a recording: that of another one.
struct RecordedBegin {
  std::shared_ptr<const Recording> source;
  std::uint64_t last_number = 0;            // of its states
  std::optional<RecordedTick> change = {};  // the edit that follows them
};

struct RecordingOptions {
  std::string world_file;  // as the recording names it
  Tick keyframe_interval = kDefaultKeyframeInterval;
  std::size_t queue_bytes = std::size_t{16} << 20;
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
  RunRecorder(std::unique_ptr<mcap::ByteSink> sink, const RecordingOptions& options);
  // Continues the journal of the options. The ticks of its tail are written to the recording.
  static Result<std::unique_ptr<RunRecorder>> Continue(Journal journal, const ResumedRun& resumed,
                                                       const RecordingOptions& options);
  ~RunRecorder() override;

  Status OnBegin(const RunStart& start) override;
  // The error is the first one of the file (a full disk).
  Status OnCommit(const CommittedTick& tick, const RunProgress& progress) override;
  Status OnProgress(const RunProgress& progress) override;
  Status OnTick(const CommittedTick& tick) override;
  bool IsReady() override;
  // Appends a state that is not one of the run's own, as if it had followed the newest; its number is computed here.
  // May wait for the disk. No call of OnTick may run meanwhile.
  Status Append(RecordedTick tick);
  // Writes from now on; OnBegin does it, too. REQUIRES: the recorder continues a journal.
  void StartWriting();
  // Waits until all ticks so far can be read from the file. Any thread may call, from OnBegin or StartWriting until
  // OnEnd.
  Status Flush();
  // Writes all ticks, and closes the file.
  Status OnEnd() override;

 private:
  // Writes the begin of the options.
  Status WriteBegin(const RecordedBegin& begin);
  void Push(RecordedTick tick);
  void Write();
  // The tail need not have the ticks that the recording has.
  Status ReleaseTail();
  // Of the thread that writes.
  bool MustFlush(std::uint64_t written) const;
  void NoteFlushed(std::uint64_t written);
  void Fail(Error error);
  // The error, unless the run continues without the journal: that is said once.
  Status Reported(const Status& failure);
  Status status() const;
  RecordedTick Convert(const CommittedTick& tick);
  bool IsKeyframe(Tick tick) const { return tick % options_.keyframe_interval == 0; }

  const RecordingOptions options_;
  std::unique_ptr<mcap::ByteSink> sink_;  // until OnBegin
  std::unique_ptr<JournalTail> tail_;     // null: no journal
  std::uint64_t released_ = 0;
  std::optional<RecordingWriter> writer_;
  std::uint64_t next_number_ = 0;
  RunProgress progress_;  // the newest, with a tail
  FrameMessage last_;     // the newest frame, without its state and events
  TickQueue queue_;
  bool dropped_ = false;  // the journal: it is of no use any more
  std::atomic<bool> failed_ = false;
  std::atomic<std::uint64_t> pushed_ = 0;  // ticks
  std::uint64_t flushed_ = 0;              // ticks that can be read; guarded by mutex_
  std::uint64_t flush_asked_ = 0;          // ticks that a caller of Flush waits for; guarded by mutex_
  std::condition_variable flush_changed_;  // with mutex_
  mutable std::mutex mutex_;
  Status status_;
  std::thread thread_;  // last, because it uses all other members
};

}  // namespace troupe
