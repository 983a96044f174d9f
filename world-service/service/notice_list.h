// NoticeList: lines for people that are still to be reported.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace troupe {

class NoticeList {
 public:
  void Add(std::string text) { notices_.push_back(std::move(text)); }
  // Drops the notice when many are waiting: a hostile peer may cause any number between two reports.
  void AddFromPeer(std::string text) {
    if (notices_.size() < kMost) Add(std::move(text));
  }
  // The notices that were not returned before.
  std::vector<std::string> Drain() { return std::exchange(notices_, {}); }

 private:
  static constexpr std::size_t kMost = 100;

  std::vector<std::string> notices_;
};

}  // namespace troupe
