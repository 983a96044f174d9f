// FloodLimiter: passes the first lines of each second on, and a count of the others, so that a hostile peer cannot fill
// a disk with reports about itself. Safe to use from several threads.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace troupe {

class FloodLimiter {
 public:
  static constexpr int kLinesInASecond = 5;

  // Receives the lines, as plain lines, on any thread, one at a time.
  using Tell = std::function<void(const std::string& line)>;

  explicit FloodLimiter(Tell tell);  // empty: nothing is reported
  ~FloodLimiter();                   // reports the count of the lines left out since the last report
  FloodLimiter(const FloodLimiter&) = delete;
  FloodLimiter& operator=(const FloodLimiter&) = delete;

  void Add(const std::string& line);

 private:
  void TellSum();

  const Tell tell_;
  std::mutex mutex_;  // guards the members below
  std::chrono::steady_clock::time_point second_began_;
  int told_ = 0;  // lines since then
  std::uint64_t left_out_ = 0;
};

}  // namespace troupe
