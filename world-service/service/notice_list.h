// NoticeList: lines for people that are still to be reported.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/utf8.h"

namespace troupe {

class NoticeList {
 public:
  void Add(std::string text) { notices_.push_back(std::move(text)); }
  // A plain line of at most kLongest bytes. Drops the notice when many are waiting: a hostile peer may cause any number
  // between two reports.
  void AddFromPeer(std::string_view text) {
    if (notices_.size() < kMost) Add(PlainLine(text, kLongest));
  }
  // The notices that were not returned before.
  std::vector<std::string> Drain() { return std::exchange(notices_, {}); }

 private:
  static constexpr std::size_t kMost = 100;
  static constexpr std::size_t kLongest = 1000;

  std::vector<std::string> notices_;
};

}  // namespace troupe
