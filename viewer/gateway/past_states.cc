#include "viewer/gateway/past_states.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "viewer/gateway/page_messages.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxSpans = 500;

}  // namespace

std::shared_ptr<const ViewedWorld> MakeViewedWorld(const SessionMessage& session, std::uint32_t number) {
  auto world = std::make_shared<ViewedWorld>();
  world->number = number;
  world->run = session.run;
  world->edition = session.world_edition;
  world->message = std::make_shared<const std::string>(EncodeWorld(session, number));
  world->scene = session.scene != nullptr ? session.scene : std::make_shared<const Scene>(session.world);
  return world;
}

std::shared_ptr<const ViewedWorld> WorldCache::Of(const SessionMessage& session) {
  const std::lock_guard lock(mutex_);
  std::erase_if(worlds_, [](const auto& world) { return world.expired(); });
  for (const auto& known : worlds_) {
    std::shared_ptr<const ViewedWorld> world = known.lock();
    if (world == nullptr || world->run != session.run || world->edition != session.world_edition) continue;
    if (world->description() == session.world) return world;
  }
  std::shared_ptr<const ViewedWorld> world = MakeViewedWorld(session, ++made_);
  worlds_.push_back(world);
  return world;
}

std::size_t SizeOf(const ViewedState& viewed) {
  const std::size_t events = viewed.events == nullptr ? 0 : viewed.events->size() * sizeof(Event);
  return sizeof viewed + MemoryOf(*viewed.state) + events;
}

EventNames NamesIn(const WorldDescription& world, const Event& event) {
  const auto name_of = [&](const std::optional<ModelId>& model) {
    return model && model->index() < world.models.size() ? world.model(*model).name : std::string();
  };
  const bool has_robot = event.robot && event.robot->index() < world.robots.size();
  return {has_robot ? world.robot(*event.robot).name : std::string(), name_of(event.other), name_of(event.object)};
}

void SpanList::Add(std::uint64_t position, Tick tick) {
  if (!spans_.empty()) {
    TimeSpan& newest = spans_.back();
    if (position == newest.last + 1 && tick == newest.tick + (position - newest.first)) {
      newest.last = position;
      return;
    }
  }
  spans_.push_back({position, position, tick});
  if (spans_.size() <= kMaxSpans) return;
  spans_[0].last = spans_[1].last;  // the oldest gap is not told any more
  spans_.erase(spans_.begin() + 1);
}

void SpanList::DropBefore(std::uint64_t position) {
  std::erase_if(spans_, [&](const TimeSpan& span) { return span.last < position; });
  if (spans_.empty() || spans_.front().first >= position) return;
  spans_.front().tick += position - spans_.front().first;
  spans_.front().first = position;
}

std::shared_ptr<const ViewedState> KeptStates::Add(ViewedState state) {
  const std::lock_guard lock(mutex_);
  state.position = next_;
  if (!states_.empty()) {
    // An edit makes one state; within an edition ticks count up, also those that were not received.
    const ViewedState& before = *states_.back();
    const Tick tick = state.state->tick;
    const bool counts_up = before.edition == state.edition && tick > before.state->tick;
    state.position = before.position + (counts_up ? tick - before.state->tick : 1);
  }
  next_ = state.position + 1;
  spans_.Add(state.position, state.state->tick);
  bytes_ += SizeOf(state);
  states_.push_back(std::make_shared<const ViewedState>(std::move(state)));
  while (bytes_ > most_bytes_ && states_.size() > 1) {
    bytes_ -= SizeOf(*states_.front());
    states_.pop_front();
  }
  spans_.DropBefore(states_.front()->position);
  return states_.back();
}

void KeptStates::Clear() {
  const std::lock_guard lock(mutex_);
  states_.clear();
  spans_.Clear();
  bytes_ = 0;
}

void KeptStates::SetNext(std::uint64_t position) {
  const std::lock_guard lock(mutex_);
  next_ = position;
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
  const auto after = std::partition_point(states_.begin(), states_.end(),
                                          [&](const auto& state) { return state->position <= position; });
  return after == states_.begin() ? states_.front() : *std::prev(after);
}

std::vector<TimeSpan> KeptStates::Spans() const {
  const std::lock_guard lock(mutex_);
  return spans_.all();
}

void RunPast::SetRecorded(std::shared_ptr<Recorded> recorded) {
  const std::lock_guard lock(mutex_);
  recorded_ = std::move(recorded);
}

std::shared_ptr<Recorded> RunPast::recorded() const {
  const std::lock_guard lock(mutex_);
  return recorded_;
}

std::optional<PastStates::Range> RunPast::range() const {
  const std::optional<Range> kept = kept_.range();
  const std::shared_ptr<Recorded> recorded = this->recorded();
  if (recorded == nullptr || !recorded->range()) return kept;
  const Range all = *recorded->range();
  return kept ? Range{std::min(all.first, kept->first), kept->last} : all;
}

std::optional<std::uint64_t> RunPast::PositionOf(Tick tick) const {
  if (const std::optional<std::uint64_t> kept = kept_.PositionOf(tick)) return kept;
  const std::shared_ptr<Recorded> recorded = this->recorded();
  return recorded == nullptr ? std::nullopt : recorded->PositionOf(tick);
}

Result<std::shared_ptr<const ViewedState>> RunPast::At(std::uint64_t position) {
  Result<std::shared_ptr<const ViewedState>> kept = kept_.At(position);
  if (kept.ok() && kept.value()->position == position) return kept;
  const std::shared_ptr<Recorded> recorded = this->recorded();
  if (recorded == nullptr) return kept;
  const bool is_recorded = recorded->range() && position <= recorded->range()->last;
  return is_recorded || !kept.ok() ? recorded->At(position) : kept;
}

std::vector<TimeSpan> RunPast::Spans() const {
  const std::shared_ptr<Recorded> recorded = this->recorded();
  std::vector<TimeSpan> kept = kept_.Spans();
  if (recorded == nullptr) return kept;
  std::vector<TimeSpan> spans = recorded->Spans();
  for (TimeSpan span : kept) {
    if (!spans.empty()) {
      TimeSpan& before = spans.back();
      if (span.last <= before.last) continue;
      // What both have, once.
      if (span.first <= before.last) {
        span.tick += before.last + 1 - span.first;
        span.first = before.last + 1;
      }
      if (span.first == before.last + 1 && span.tick == before.tick + (span.first - before.first)) {
        before.last = span.last;
        continue;
      }
    }
    spans.push_back(span);
  }
  return spans;
}

}  // namespace troupe
