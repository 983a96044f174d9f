// SignalWatch: turns this process's signals into something to poll. While one lives, SIGINT, SIGTERM, SIGHUP and
// SIGCHLD do not act by themselves. Make it before any other thread starts, so that all threads inherit the mask.
#pragma once

#include <signal.h>

namespace troupe {

class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  // Readable when a signal is pending.
  int descriptor() const { return descriptor_; }
  // Takes all pending signals. True if one of them asks to stop.
  bool TakeStopRequest();

 private:
  sigset_t before_;
  int descriptor_ = -1;
};

}  // namespace troupe
