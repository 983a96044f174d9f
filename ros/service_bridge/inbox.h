// Inbox: the threads of Fast DDS tell the bridge's own thread through it which of its parts have something to do. So
// the parts need no locks, and no call into Fast DDS is made while one of its threads waits.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

namespace troupe::ros {

class Inbox {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using PartId = std::uint64_t;

  PartId NewPart() {
    const std::lock_guard lock(mutex_);
    return ++last_part_;
  }
  // Safe to call from any thread.
  void Notify(PartId part) {
    const std::lock_guard lock(mutex_);
    parts_.insert(part);
    changed_.notify_one();
  }
  void Stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_one();
  }

  bool stopped() const {
    const std::lock_guard lock(mutex_);
    return stopped_;
  }
  // The parts that were named since the last call. Waits for one, for Stop, or for `until`.
  std::set<PartId> Wait(const std::optional<Time>& until) {
    std::unique_lock lock(mutex_);
    const auto is_over = [this] { return stopped_ || !parts_.empty(); };
    if (until) {
      changed_.wait_until(lock, *until, is_over);
    } else {
      changed_.wait(lock, is_over);
    }
    return std::exchange(parts_, {});
  }

 private:
  mutable std::mutex mutex_;  // guards all
  std::condition_variable changed_;
  std::set<PartId> parts_;
  PartId last_part_ = 0;
  bool stopped_ = false;
};

}  // namespace troupe::ros
