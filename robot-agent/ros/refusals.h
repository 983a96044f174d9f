// Refusals: counts what one input refused, and tells of it at 1, 10, 100, ...: one who sends a thousand a second would
// fill the log.
#pragma once

#include <cstdint>

namespace troupe {

class Refusals {
 public:
  void Count() { ++count_; }

  // How many there were so far, when it is time to tell; else 0.
  std::uint64_t TakeDue() {
    if (count_ == 0 || (told_ > 0 && count_ < 10 * told_)) return 0;
    told_ = count_;
    return count_;
  }

 private:
  std::uint64_t count_ = 0;
  std::uint64_t told_ = 0;
};

}  // namespace troupe
