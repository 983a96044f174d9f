// Refusals: counts the refused commands of one input, and reports the count at 1, 10, 100, ..., so that a peer that
// sends a thousand a second does not fill the log.
#pragma once

#include <cstdint>

namespace troupe {

class Refusals {
 public:
  void Count() { ++count_; }

  // The count so far if a report is due, else 0.
  std::uint64_t CountToReport() {
    if (count_ == 0 || (reported_ > 0 && count_ < 10 * reported_)) return 0;
    reported_ = count_;
    return count_;
  }

 private:
  std::uint64_t count_ = 0;
  std::uint64_t reported_ = 0;
};

}  // namespace troupe
