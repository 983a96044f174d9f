// NetworkLog: the messages of Cyclone DDS about the network, for instance about samples whose layout is not that of
// their type. Only the first lines of each second are reported, the others as a count, so that a hostile peer cannot
// fill a disk.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace troupe::dds {

// One for a process, which outlives its participants. Without one, Cyclone prints to standard error.
class NetworkLog {
 public:
  static constexpr int kLinesInASecond = 5;

  // Receives the lines, on any thread, one at a time.
  using Tell = std::function<void(const std::string& line)>;

  explicit NetworkLog(Tell tell);
  ~NetworkLog();  // reports the count of the lines left out since the last report
  NetworkLog(const NetworkLog&) = delete;
  NetworkLog& operator=(const NetworkLog&) = delete;

 private:
  void Add(const std::string& line);
  void TellSum();

  const Tell tell_;
  std::mutex mutex_;  // guards the members below
  std::chrono::steady_clock::time_point second_began_;
  int told_ = 0;  // lines since then
  std::uint64_t left_out_ = 0;
};

}  // namespace troupe::dds
