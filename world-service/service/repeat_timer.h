// RepeatTimer: when to send a frame again that somebody seems to have missed. Times in s, of any clock.
#pragma once

#include <algorithm>

namespace troupe {

class RepeatTimer {
 public:
  // A frame was sent for the first time. The first repeat comes after `first_wait`, each later one after twice the wait
  // before, up to 1 s.
  void Start(double now, double first_wait) {
    wait_ = first_wait;
    due_ = now + wait_;
  }
  // An answer came. As long as answers come, the others are probably just busy, and more frames would make it worse.
  void Answered(double now) { due_ = now + wait_; }
  void Repeated(double now) {
    wait_ = std::min(2.0 * wait_, 1.0);
    due_ = now + wait_;
  }
  double due() const { return due_; }

 private:
  double wait_ = 0.0;
  double due_ = 0.0;
};

}  // namespace troupe
