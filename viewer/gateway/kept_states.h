// KeptStates: the newest states of a live run, in a bounded memory.
//
// Threads: any; Add on one.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>

#include "viewer/gateway/past_state.h"
#include "viewer/gateway/past_states.h"

namespace troupe {

class KeptStates final : public PastStates {
 public:
  explicit KeptStates(std::size_t bytes) : most_bytes_(bytes) {}

  // Appends a state, whose position is set, and drops the oldest ones that are too many. Returns its position.
  std::uint64_t Add(PastState state);
  void Clear();

  std::optional<Range> range() const override;
  std::optional<std::uint64_t> PositionOf(Tick tick) const override;
  Result<std::shared_ptr<const PastState>> At(std::uint64_t position) override;

 private:
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;  // guards the others
  std::deque<std::shared_ptr<const PastState>> states_;
  std::size_t bytes_ = 0;
  std::uint64_t next_ = 0;  // position of the next one
};

}  // namespace troupe
