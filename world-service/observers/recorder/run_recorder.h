// RunRecorder: an observer that writes a recording of the run (docs/recording.md). A run that is faster than the disk
// waits, and loses no tick.
//
// Two files at different times: the recording itself is compressed in chunks on a thread of its own; if it is a
// journal, its tail gets each tick uncompressed in OnCommit, before the agents see the frame. When a chunk is in the
// file, the tail drops the ticks of it. So a killed service loses no tick that an agent has seen, and the tick pays for
// one small write.
//
// Memory is bounded: the queue is full at queue_bytes (estimated), and IsReady then makes the run wait until half of it
// is free, so that a slow disk stops the run seldom and for longer rather than at every tick.
//
// A failed write is remembered and returned by every later call; the run ends with it, unless the journal is optional.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "recording/journal.h"
#include "recording/mcap/byte_stream.h"
#include "recording/recorded_run.h"
#include "recording/recording.h"
#include "recording/recording_writer.h"
#include "transport/protocol/run_progress.h"
#include "troupe/result.h"
#include "world-service/service/resumed_run.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// RecordingThread: writes the ticks of a run to a recording on a thread of its own, behind a queue in bounded memory.
//
// Any thread may call; only the thread of its own uses the writer.
class RecordingThread {
 public:
  static constexpr std::size_t kQueueBytes = std::size_t{16} << 20;

  struct Options {
    std::size_t queue_bytes = kQueueBytes;  // as estimated
    bool sync = false;                      // chunks survive a loss of power before on_written is called
    // On the thread of its own: the number of the first tick that is in no chunk of the file; all ticks are written.
    std::function<void(std::uint64_t first_unwritten)> on_written = {};
    std::function<void()> on_closed = {};
  };

  RecordingThread(RecordingWriter writer, Options options);
  // As Close, if Start was called.
  ~RecordingThread();

  // Ticks are written from now on. A second call changes nothing.
  void Start();
  // False from when the queue is full until half of it is free. A tick may be pushed all the same. True after a
  // failure.
  bool has_room() const;
  // An empty tick with the memory of one that was written before, for Push.
  RecordedTick Reuse();
  void Push(RecordedTick tick);
  // Waits until all ticks so far can be read from the file. REQUIRES: Start was called.
  Status Flush();
  // Writes all ticks, and closes the file. Without Start the file stays as it is.
  Status Close();

  // The first failure: that of the file, or of Fail. No tick is written after it.
  Status status() const;
  void Fail(Status failure);

 private:
  struct Entry {
    RecordedTick tick;
    std::size_t size = 0;  // bytes
  };
  // The next work of the thread.
  struct Work {
    std::optional<RecordedTick> tick;
    bool flushes = false;  // after the tick
    bool closes = false;   // the queue is closed, and empty
  };

  void Join();
  void Run();
  // Waits for work, or until a chunk is to be ended for its age; nothing after a failure.
  std::optional<Work> Await();
  Status Write(const Work& work);
  void Finish(Work work);

  const Options options_;
  // Members of the thread alone.
  RecordingWriter writer_;
  std::uint64_t first_unwritten_ = 0;                  // that was reported
  std::chrono::steady_clock::time_point chunk_ended_;  // the newest that was ended for a flush or its age

  mutable std::mutex mutex_;  // guards all members below
  std::condition_variable changed_;
  std::deque<Entry> entries_;
  std::vector<RecordedTick> spare_;
  std::size_t size_ = 0;  // of the entries, bytes
  bool full_ = false;
  bool closed_ = false;
  std::uint64_t pushed_ = 0;       // ticks
  std::uint64_t popped_ = 0;       // as above
  std::uint64_t flushed_ = 0;      // ticks that can be read
  std::uint64_t flush_asked_ = 0;  // ticks that a caller of Flush waits for
  Status status_;
  std::thread thread_;
};

// The first part of a recording: that of another one.
struct RecordedStart {
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
  std::shared_ptr<const RecordedStart> begin = {};  // null: the recording begins with the run
  // Of the scenario, for one that begins with the run; others have those of their start.
  std::vector<NamedExpectation> expectations = {};
  std::vector<NamedRegion> regions = {};
  bool journal_is_optional = false;  // a run whose journal cannot be written continues without it
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
  // Appends the states of a rewind that `next` makes, until it returns false, as if they had followed the newest; their
  // numbers are computed here. All of them, or after an error no other state: the recording then ends, and the run that
  // is recorded, too. May wait for the disk. The journal says that the run is being rewound from the first of them
  // until the next OnCommit. REQUIRES: the run commits no tick meanwhile.
  using TickSource = std::function<Result<bool>(RecordedTick&)>;
  Status AppendRewind(const TickSource& next);
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
  Status WriteStart(const RecordedStart& begin, RecordingWriter& writer);
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
