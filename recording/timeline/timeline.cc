#include "recording/timeline/timeline.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "troupe/check.h"

namespace troupe {
namespace {

std::optional<std::uint64_t> Find(const TimeSpan& span, Tick tick) {
  const bool is_in = tick >= span.tick && tick - span.tick <= span.last - span.first;
  return is_in ? std::optional(span.first + (tick - span.tick)) : std::nullopt;
}

}  // namespace

std::shared_ptr<const TimelineWorld> WorldCache::Of(const SessionMessage& session, std::shared_ptr<const Scene> scene) {
  const std::lock_guard lock(mutex_);
  std::erase_if(worlds_, [](const auto& world) { return world.expired(); });
  for (const auto& known : worlds_) {
    std::shared_ptr<const TimelineWorld> world = known.lock();
    if (world == nullptr || world->run != session.run || world->edition != session.world_edition) continue;
    if (world->description() == session.world) return world;
  }
  auto world = std::make_shared<TimelineWorld>();
  world->number = ++made_;
  world->run = session.run;
  world->edition = session.world_edition;
  if (encode_) world->message = std::make_shared<const std::string>(encode_(session, world->number));
  world->scene = scene != nullptr ? std::move(scene) : std::make_shared<const Scene>(session.world);
  worlds_.push_back(world);
  return world;
}

std::size_t SizeOf(const TimelineState& state) {
  const std::size_t events = state.events == nullptr ? 0 : state.events->size() * sizeof(Event);
  return sizeof state + MemoryOf(*state.state) + events;
}

EventNames NamesIn(const WorldDescription& world, const Event& event) {
  const auto name_of = [&](const std::optional<ModelId>& model) {
    return model && model->index() < world.models.size() ? world.model(*model).name : std::string();
  };
  const bool has_robot = event.robot && event.robot->index() < world.robots.size();
  return {has_robot ? world.robot(*event.robot).name : std::string(), name_of(event.other), name_of(event.object)};
}

std::optional<std::uint64_t> TimeSpans::First(Tick tick) const {
  for (const TimeSpan& span : spans_) {
    if (const auto found = Find(span, tick)) return found;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> TimeSpans::Last(Tick tick) const {
  for (auto span = spans_.rbegin(); span != spans_.rend(); ++span) {
    if (const auto found = Find(*span, tick)) return found;
  }
  return std::nullopt;
}

Tick TimeSpans::greatest() const {
  Tick greatest = 0;
  for (const TimeSpan& span : spans_) greatest = std::max(greatest, span.tick + (span.last - span.first));
  return greatest;
}

Tick TimeSpans::TickAt(std::uint64_t position) const {
  const auto after =
      std::partition_point(spans_.begin(), spans_.end(), [&](const TimeSpan& span) { return span.first <= position; });
  TROUPE_CHECK(after != spans_.begin());
  return std::prev(after)->tick + (position - std::prev(after)->first);
}

std::uint64_t TimeSpans::PositionOf(StatePlace place) const {
  const auto after = std::partition_point(spans_.begin(), spans_.end(), [&](const TimeSpan& span) {
    return StatePlace{span.edition, span.tick} <= place;
  });
  if (after == spans_.begin()) return 0;
  const TimeSpan& before = *std::prev(after);
  // A state of a later edition without a span of its own is as many edits behind: each edit makes one state.
  const std::uint64_t position = before.edition == place.edition ? before.first + (place.tick - before.tick)
                                                                 : before.last + (place.edition - before.edition);
  return after == spans_.end() ? position : std::min(position, after->first);
}

std::uint64_t TimeSpans::BeginOf(Edition edition) const {
  const auto found =
      std::partition_point(spans_.begin(), spans_.end(), [&](const TimeSpan& span) { return span.edition < edition; });
  if (found != spans_.end()) return found->first;
  return empty() ? 0 : last() + 1;
}

void TimeSpans::Append(TimeSpan span) {
  if (!empty()) {
    TimeSpan& newest = spans_.back();
    if (span.last <= newest.last) return;
    // An overlap, as of states that are received twice: the part that is known already is left out.
    if (span.first <= newest.last) {
      span.tick += newest.last + 1 - span.first;
      span.first = newest.last + 1;
    }
    if (span.first == newest.last + 1 && span.tick == newest.tick + (span.first - newest.first)) {
      newest.last = span.last;
      return;
    }
  }
  spans_.push_back(span);
}

void TimeSpans::DropBefore(std::uint64_t position) {
  std::erase_if(spans_, [&](const TimeSpan& span) { return span.last < position; });
  if (empty() || first() >= position) return;
  spans_.front().tick += position - first();
  spans_.front().first = position;
}

void TimeSpans::DropAfter(std::uint64_t position) {
  std::erase_if(spans_, [&](const TimeSpan& span) { return span.first > position; });
  if (!empty()) spans_.back().last = std::min(last(), position);
}

void KeptStates::Add(SharedState state) {
  const std::uint64_t position = state->position;
  bytes_ += SizeOf(*state);
  if (const auto [place, is_new] = states_.try_emplace(position, state); !is_new) {
    bytes_ -= SizeOf(*std::exchange(place->second, std::move(state)));
  }
  while (bytes_ > max_bytes_ && states_.size() > 1) {
    // Only one of the ends can be the farthest: the states between are nearer.
    const bool is_first_farther = position - first() > states_.rbegin()->first - position;
    const auto dropped = is_first_farther ? states_.begin() : std::prev(states_.end());
    bytes_ -= SizeOf(*dropped->second);
    states_.erase(dropped);
  }
}

void KeptStates::Clear() {
  states_.clear();
  bytes_ = 0;
}

SharedState KeptStates::Find(std::uint64_t position) const {
  const auto found = states_.find(position);
  return found == states_.end() ? nullptr : found->second;
}

SharedState KeptStates::Nearest(std::uint64_t position) const {
  const auto after = states_.upper_bound(position);
  return after == states_.begin() ? after->second : std::prev(after)->second;
}

}  // namespace troupe
