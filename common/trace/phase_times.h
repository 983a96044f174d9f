// PhaseTimes: how long the phases of the service take in a tick, on average over about the last second.
//
// Threads: one at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/trace/tick_trace.h"

namespace troupe {

class PhaseTimes {
 public:
  // Ends the phase before and begins this one, at `now`, ns of a clock that never decreases. Each kStep begins a tick.
  void Enter(TickPhase phase, std::int64_t now = TraceFile::Now());
  // The time since Enter does not count: the phase in progress begins now.
  void Restart(std::int64_t now = TraceFile::Now());

  // s, of one tick: all parts of the phase together. 0 without ticks in the last seconds.
  double Mean(TickPhase phase, std::int64_t now = TraceFile::Now()) const;

 private:
  static constexpr std::size_t kPhases = 8;
  // The phases that ended within a stretch of time.
  struct Window {
    std::int64_t begin = 0;
    std::uint64_t ticks = 0;
    std::array<std::int64_t, kPhases> times = {};  // ns, by phase
  };

  std::optional<TickPhase> phase_;
  std::int64_t entered_ = 0;
  Window now_;
  Window before_;
};

// Notes the beginning of a phase in both, where they are not null.
inline void Enter(TraceLane* lane, PhaseTimes* times, TickPhase phase, Tick tick) {
  Enter(lane, phase, tick);
  if (times != nullptr) times->Enter(phase);
}

}  // namespace troupe
