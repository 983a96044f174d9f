// RecordingThread: writes the ticks of a run to a recording on a thread of its own, behind a queue in bounded memory.
//
// Any thread may call; only the thread of its own uses the writer.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "recording/recorded_run.h"
#include "recording/recording_writer.h"
#include "troupe/result.h"

namespace troupe {

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
  void Fail(const Error& error);

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

  void Run();
  // Waits for work, or until a chunk is to be ended for its age; nothing after a failure.
  std::optional<Work> Await();
  Status Write(const Work& work);
  void Finish(Work work);

  const Options options_;
  // Of the thread alone.
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
  std::uint64_t popped_ = 0;       // likewise
  std::uint64_t flushed_ = 0;      // ticks that can be read
  std::uint64_t flush_asked_ = 0;  // ticks that a caller of Flush waits for
  Status status_;
  std::thread thread_;
};

}  // namespace troupe
