#include "viewer/gateway/kept_states.h"

#include <algorithm>
#include <utility>

namespace troupe {

std::uint64_t KeptStates::Add(PastState state) {
  const std::lock_guard lock(mutex_);
  state.position = next_++;
  bytes_ += SizeOf(state);
  states_.push_back(std::make_shared<const PastState>(std::move(state)));
  while (bytes_ > most_bytes_ && states_.size() > 1) {
    bytes_ -= SizeOf(*states_.front());
    states_.pop_front();
  }
  return states_.back()->position;
}

void KeptStates::Clear() {
  const std::lock_guard lock(mutex_);
  states_.clear();
  bytes_ = 0;
}

std::optional<PastStates::Range> KeptStates::range() const {
  const std::lock_guard lock(mutex_);
  if (states_.empty()) return std::nullopt;
  return Range{states_.front()->position, states_.back()->position};
}

std::optional<std::uint64_t> KeptStates::PositionOf(Tick tick) const {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(states_.rbegin(), states_.rend(), [&](const auto& past) { return past->state->tick == tick; });
  return found == states_.rend() ? std::nullopt : std::optional((*found)->position);
}

Result<std::shared_ptr<const PastState>> KeptStates::At(std::uint64_t position) {
  const std::lock_guard lock(mutex_);
  if (states_.empty()) return Failure("there is no past state");
  // The positions have no gaps.
  const std::uint64_t first = states_.front()->position;
  return states_[std::clamp(position, first, states_.back()->position) - first];
}

}  // namespace troupe
