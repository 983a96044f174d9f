// PastStates: the states of a run that viewers can go back to, in their order: those that the gateway has seen of a
// live run (kept_states.h), or all of a recording.
//
// A state is named by its position, which counts the states from the first on: a tick may be repeated after edits.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "troupe/result.h"
#include "viewer/gateway/past_state.h"

namespace troupe {

class PastStates {
 public:
  struct Range {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    bool operator==(const Range&) const = default;
  };

  virtual ~PastStates() = default;

  // Both may be called on any thread. Nothing: there is no state (of that tick).
  virtual std::optional<Range> range() const = 0;
  virtual std::optional<std::uint64_t> PositionOf(Tick tick) const = 0;  // the newest one

  // The state at a position, or at the nearest that there is. May take some time. Called on one thread. The error is a
  // state that cannot be read.
  virtual Result<std::shared_ptr<const PastState>> At(std::uint64_t position) = 0;
};

// A recording: all of its states are in the past.
class Recorded : public PastStates {
 public:
  // In their order, at most the first kEventsKept.
  virtual std::vector<NumberedEvent> Events() const = 0;
};

}  // namespace troupe
