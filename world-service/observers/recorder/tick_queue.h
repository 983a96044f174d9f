// TickQueue: hands ticks over from the thread of a run to the one that writes them, in bounded memory.
//
// Any thread may call.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "recording/recorded_run.h"

namespace troupe {

class TickQueue {
 public:
  // `capacity`: bytes, as estimated.
  explicit TickQueue(std::size_t capacity) : capacity_(capacity) {}

  // False from when the queue is full until half of it is free. A tick may be added all the same.
  bool has_room() const;
  // An empty tick with the memory of one that was written before, for Push.
  RecordedTick Reuse();
  void Push(RecordedTick tick);

  // Waits for a tick; nothing at the end of the queue, or after `seconds` without one.
  std::optional<RecordedTick> Pop(double seconds);
  // The tick of Pop is written.
  void Recycle(RecordedTick tick);
  // The present or the next Pop without a tick returns at once.
  void Interrupt();
  // No tick follows.
  void Close();
  // It is closed, and all ticks were popped.
  bool done() const;

 private:
  struct Entry {
    RecordedTick tick;
    std::size_t size = 0;  // bytes
  };

  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> entries_;
  std::vector<RecordedTick> spare_;
  std::size_t size_ = 0;  // of the entries, bytes
  bool full_ = false;
  bool closed_ = false;
  bool interrupted_ = false;
};

}  // namespace troupe
