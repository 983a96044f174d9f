// SignalWatch: makes this process's signals readable from a descriptor. During its lifetime SIGINT, SIGTERM, SIGHUP and
// SIGCHLD have no other effect. REQUIRES: constructed before any other thread starts, so that all threads inherit the
// signal mask.
#pragma once

#include <signal.h>

#include <utility>

namespace troupe {

class SignalWatch {
 public:
  // Throws std::system_error without resources.
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  // Readable when a signal is pending.
  int descriptor() const { return descriptor_; }
  // Consumes all pending signals. True if one of them requests a stop.
  bool ReadStopRequest();
  // Whether ReadStopRequest has read since the last call that a child of this process has ended.
  bool ReadChildEnd() { return std::exchange(child_ended_, false); }
  // Whether ReadStopRequest has ever returned true.
  bool stop_requested() const { return stop_requested_; }

 private:
  sigset_t before_;
  int descriptor_ = -1;
  bool stop_requested_ = false;
  bool child_ended_ = false;
};

}  // namespace troupe
