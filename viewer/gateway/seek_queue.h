// SeekQueue: reads past states for viewers, on a thread of its own: a state of a recording may take some time. Of each
// viewer only the newest request counts.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "troupe/result.h"
#include "viewer/gateway/control_queue.h"
#include "viewer/gateway/past_states.h"

namespace troupe {

class SeekQueue {
 public:
  struct Found {
    ViewerId viewer = 0;
    Result<std::shared_ptr<const PastState>> state;
  };

  // The states must outlive this. `on_found` is called, on the thread of the queue, when TakeFound has some.
  SeekQueue(PastStates& states, std::function<void()> on_found);
  ~SeekQueue();
  SeekQueue(const SeekQueue&) = delete;
  SeekQueue& operator=(const SeekQueue&) = delete;

  void Add(ViewerId viewer, std::uint64_t position);
  void Remove(ViewerId viewer);
  std::vector<Found> TakeFound();

 private:
  void Run();

  PastStates& states_;
  const std::function<void()> on_found_;
  std::mutex mutex_;  // guards the next three
  std::map<ViewerId, std::uint64_t> wanted_;
  std::vector<Found> found_;
  bool ending_ = false;
  std::condition_variable changed_;
  std::thread thread_;  // last
};

}  // namespace troupe
