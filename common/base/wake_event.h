// WakeEvent: wakes a thread that waits for descriptors, from any other one.
//
// An eventfd rather than a condition variable, because the thread waits for sockets at the same time (poll). Signals
// before Clear are one.
#pragma once

#include <signal.h>

#include <atomic>
#include <functional>
#include <thread>

namespace troupe {

class WakeEvent {
 public:
  // Throws std::system_error without resources.
  WakeEvent();
  ~WakeEvent();
  WakeEvent(const WakeEvent&) = delete;
  WakeEvent& operator=(const WakeEvent&) = delete;

  // Readable from Signal on until Clear.
  int descriptor() const { return descriptor_; }
  void Signal() const;
  void Clear() const;

 private:
  const int descriptor_;
};

// StopSignals: SIGINT, SIGTERM and SIGHUP as a flag. While an instance lives they do not end the process. REQUIRES:
// constructed before any other thread starts, so that all threads block these signals.
class StopSignals {
 public:
  // `on_request` is called when a signal has arrived, on a thread of this object. Throws std::system_error without
  // resources.
  explicit StopSignals(std::function<void()> on_request = {});
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  // True from the first of these signals on.
  const std::atomic<bool>& requested() const { return requested_; }

 private:
  void Watch();

  sigset_t before_;
  int signals_ = -1;     // readable when a signal has arrived
  const WakeEvent end_;  // of the watch
  std::atomic<bool> requested_ = false;
  const std::function<void()> on_request_;
  std::thread watch_;
};

}  // namespace troupe
