// RepeatTimer: when to send a frame again that somebody seems to have missed. It learns how long answers take, from
// those that came before anything was repeated. Times in s, of any clock.
#pragma once

#include <algorithm>
#include <cmath>

namespace troupe {

class RepeatTimer {
 public:
  static constexpr double kShortestWait = 0.004;
  static constexpr double kLongestFirstWait = 0.05;  // also as long as nothing was learned
  static constexpr double kLongestWait = 1.0;

  // A frame was sent for the first time; the one before is answered. The first repeat comes after what was learned,
  // each later one after twice the wait before.
  void Start(double now) {
    if (heard_) Learn(longest_);
    Start(now, std::clamp(mean_ + 4.0 * deviation_, kShortestWait, kLongestFirstWait));
  }
  // The same with a wait of the caller's choice; nothing is learned from it.
  void Start(double now, double first_wait) {
    heard_ = repeated_ = false;
    longest_ = 0.0;
    last_ = now;
    wait_ = first_wait;
    due_ = now + wait_;
  }
  // An answer came. As long as answers come, the others are probably just busy, and more frames would make it worse.
  void Answered(double now) {
    if (!repeated_) {
      heard_ = true;
      longest_ = std::max(longest_, now - last_);
      last_ = now;
    }
    due_ = now + wait_;
  }
  void Repeated(double now) {
    repeated_ = true;
    wait_ = std::min(2.0 * wait_, kLongestWait);
    due_ = now + wait_;
  }
  // An answer came twice: a repeat was for nothing, so answers take longer than was thought.
  void Needless() { mean_ = std::min(1.25 * mean_ + 0.001, kLongestFirstWait); }
  double due() const { return due_; }

 private:
  // As TCP learns its round-trip time.
  void Learn(double longest) {
    const double surprise = longest - mean_;
    mean_ += surprise / 8.0;
    deviation_ += (std::abs(surprise) - deviation_) / 4.0;
  }

  double mean_ = kLongestFirstWait;  // of the longest silence in a tick
  double deviation_ = 0.0;
  double wait_ = 0.0;
  double due_ = 0.0;
  // Of the tick that is open.
  double last_ = 0.0;     // when something came
  double longest_ = 0.0;  // silence
  bool heard_ = false;
  bool repeated_ = false;
};

}  // namespace troupe
