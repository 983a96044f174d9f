// EventQueue: calls in the order of their virtual times, s. Calls for the same time are made in the order of At.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace troupe::faults {

class EventQueue {
 public:
  double now() const { return now_; }
  std::size_t size() const { return events_.size(); }

  void At(double time, std::function<void()> call) {
    events_.push_back({std::max(time, now_), next_++, std::move(call)});
    std::push_heap(events_.begin(), events_.end(), IsLater);
  }
  void After(double seconds, std::function<void()> call) { At(now_ + seconds, std::move(call)); }

  // Makes the next call, unless its time is after `end`: then now() is `end`, and the result false.
  bool Advance(double end) {
    if (events_.empty() || events_.front().time > end) {
      now_ = std::max(now_, end);
      return false;
    }
    std::pop_heap(events_.begin(), events_.end(), IsLater);
    const Event event = std::move(events_.back());
    events_.pop_back();
    now_ = event.time;
    event.call();
    return true;
  }

 private:
  struct Event {
    double time = 0.0;
    std::uint64_t number = 0;
    std::function<void()> call;
  };
  static bool IsLater(const Event& a, const Event& b) {
    return a.time != b.time ? a.time > b.time : a.number > b.number;
  }

  double now_ = 0.0;
  std::uint64_t next_ = 0;
  std::vector<Event> events_;  // a heap
};

}  // namespace troupe::faults
