#include "viewer/gateway/past_states.h"

#include <algorithm>
#include <utility>

#include "viewer/gateway/page_messages.h"

namespace troupe {

std::shared_ptr<const ViewedWorld> MakeViewedWorld(const SessionMessage& session, std::uint32_t number) {
  auto world = std::make_shared<ViewedWorld>();
  world->number = number;
  world->run = session.run;
  world->edition = session.world_edition;
  world->message = std::make_shared<const std::string>(EncodeWorld(session, number));
  world->scene = std::make_shared<const Scene>(session.world);
  return world;
}

std::size_t SizeOf(const ViewedState& viewed) {
  return sizeof viewed + MemoryOf(*viewed.state);
}

EventNames NamesIn(const WorldDescription& world, const Event& event) {
  const auto name_of = [&](const std::optional<ModelId>& model) {
    return model && model->index() < world.models.size() ? world.model(*model).name : std::string();
  };
  const bool has_robot = event.robot && event.robot->index() < world.robots.size();
  return {has_robot ? world.robot(*event.robot).name : std::string(), name_of(event.other), name_of(event.object)};
}

std::shared_ptr<const ViewedState> KeptStates::Add(ViewedState state) {
  const std::lock_guard lock(mutex_);
  state.position = next_++;
  bytes_ += SizeOf(state);
  states_.push_back(std::make_shared<const ViewedState>(std::move(state)));
  while (bytes_ > most_bytes_ && states_.size() > 1) {
    bytes_ -= SizeOf(*states_.front());
    states_.pop_front();
  }
  return states_.back();
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

Result<std::shared_ptr<const ViewedState>> KeptStates::At(std::uint64_t position) {
  const std::lock_guard lock(mutex_);
  if (states_.empty()) return Failure("there is no past state");
  // The positions have no gaps.
  const std::uint64_t first = states_.front()->position;
  return states_[std::clamp(position, first, states_.back()->position) - first];
}

}  // namespace troupe
