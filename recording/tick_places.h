// TickPlaces: the places in a recording of the states of a tick. Ticks count up from one edit to the next; an edit may
// set them back, so that a tick has several states.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "troupe/ids.h"

namespace troupe {

class TickPlaces {
 public:
  // The first state is that of tick 0 at log time 0. `end`: the log time of the last.
  TickPlaces(std::int64_t interval_ns, std::uint64_t end);

  // The next edit: from its log time on, ticks count from `tick`.
  void AddEdit(std::uint64_t log_time, Tick tick, std::int64_t interval_ns);

  // The log times of the first and of the last states of a tick; nothing if there are none.
  std::optional<std::uint64_t> First(Tick tick) const;
  std::optional<std::uint64_t> Last(Tick tick) const;

  Tick greatest() const;
  std::uint64_t end() const { return end_; }
  // Of the ticks since the newest edit.
  std::int64_t interval_ns() const { return static_cast<std::int64_t>(parts_.back().interval_ns); }
  std::size_t edits() const { return parts_.size() - 1; }

 private:
  // The states from an edit to the next.
  struct Part {
    std::uint64_t begin = 0;  // log time
    Tick tick = 0;            // at its begin
    std::uint64_t interval_ns = 1;
  };
  std::uint64_t EndOf(std::size_t part) const;
  Tick LastTickOf(std::size_t part) const;
  std::optional<std::uint64_t> Find(std::size_t part, Tick tick) const;

  std::vector<Part> parts_;
  std::uint64_t end_;
};

}  // namespace troupe
