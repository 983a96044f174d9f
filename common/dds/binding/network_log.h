// NetworkLog: what Cyclone DDS has to say of the network, for instance of samples that are not laid out as their type
// says. All is counted; of much in a second only the first lines are told, so that a hostile peer cannot fill a disk.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace troupe::dds {

// One for a process, made before its participants and gone after them. Without one, all goes to standard error.
class NetworkLog {
 public:
  static constexpr int kLinesInASecond = 5;

  // Gets lines, from any thread, one at a time.
  using Tell = std::function<void(const std::string& line)>;

  explicit NetworkLog(Tell tell);
  ~NetworkLog();  // tells how many lines were left out and not told yet
  NetworkLog(const NetworkLog&) = delete;
  NetworkLog& operator=(const NetworkLog&) = delete;

 private:
  void Take(const std::string& line);
  void TellSum();

  const Tell tell_;
  std::mutex mutex_;  // for what follows
  std::chrono::steady_clock::time_point second_began_;
  int told_ = 0;  // since then
  std::uint64_t left_out_ = 0;
};

}  // namespace troupe::dds
