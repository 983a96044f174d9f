#include "launcher/commands/recorded_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

constexpr std::size_t kMostKeptBytes = std::size_t{128} << 20;
// Stepping on is quicker than starting at a keyframe for at most this many states.
constexpr std::uint64_t kStepOn = 100;

}  // namespace

Result<std::unique_ptr<RecordedStates>> RecordedStates::Create(RunSoFar run, WorldShelf& shelf) {
  if (Status other = CheckStepVersion(run.recording); !other.ok()) return other.error();
  std::unique_ptr<RecordedStates> states(new RecordedStates(std::move(run), shelf));
  const Recording& recording = states->run_.recording;
  std::optional<std::string>& damage = states->damage_;
  damage = states->ReadPlaces();
  if (!damage && recording.damage()) damage = recording.damage()->problem;
  if (states->places_.empty()) {
    return Error{{recording.name()}, fmt::format("found no tick: {}", damage.value_or("the recording is empty"))};
  }
  return states;
}

std::optional<std::string> RecordedStates::ReadPlaces() {
  RunReader reader(run_);
  RecordedTick tick;
  std::optional<ReplayedWorld> edited;
  std::uint64_t events = 0;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error().message;
    if (!more.value()) return std::nullopt;
    if (tick.edit) {
      if (!edited) edited.emplace(run_.recording);
      if (Status problem = edited->ApplyAlone(tick.number, *tick.edit); !problem.ok()) return problem.error().message;
    }
    const WorldDescription& world = edited ? edited->world() : run_.recording.run().world;
    for (const Event& event : tick.events) {
      events_.push_back({++events, places_.size(), event, NamesIn(world, event)});
      if (events_.size() > kEventsKept) events_.pop_front();
    }
    has_edits_ = has_edits_ || tick.edit.has_value();
    spans_.Add(places_.size(), tick.tick);
    // The ticks of a tail have no log time.
    const std::uint64_t before = places_.empty() ? 0 : places_.back().log_time;
    places_.push_back({tick.tick, std::max(tick.log_time, before), tick.edition});
  }
}

std::optional<std::uint64_t> RecordedStates::PositionOf(Tick tick) const {
  const auto found =
      std::find_if(places_.rbegin(), places_.rend(), [&](const Place& place) { return place.tick == tick; });
  if (found == places_.rend()) return std::nullopt;
  return static_cast<std::uint64_t>(places_.rend() - found) - 1;
}

std::uint64_t RecordedStates::PositionOf(StatePlace place) const {
  const auto after = std::partition_point(places_.begin(), places_.end(), [&](const Place& known) {
    return StatePlace{known.edition, known.tick} <= place;
  });
  if (after == places_.begin()) return 0;
  const Place& before = *std::prev(after);
  const auto position = static_cast<std::uint64_t>(after - places_.begin()) - 1;
  const bool is_same_edition = before.edition == place.edition;
  return position + (is_same_edition ? place.tick - before.tick : std::uint64_t{place.edition - before.edition});
}

Result<std::shared_ptr<const ViewedState>> RecordedStates::At(std::uint64_t position) {
  position = std::min<std::uint64_t>(position, places_.size() - 1);
  if (const auto kept = kept_.find(position); kept != kept_.end()) return kept->second;
  if (!position_ || *position_ > position || position - *position_ > kStepOn) {
    if (Status failure = Restart(position); !failure.ok()) return failure.error();
  }
  while (!position_ || *position_ < position) {
    if (Status failure = Advance(); !failure.ok()) {
      position_.reset();
      return Error{{run_.recording.name()}, failure.error().message};
    }
  }
  return kept_.at(position);
}

Status RecordedStates::Restart(std::uint64_t position) {
  position_.reset();
  std::uint64_t log_time = places_[position].log_time;
  for (;;) {
    const std::optional<std::size_t> chunk = run_.recording.KeyframeBefore(log_time);
    if (!chunk || *chunk == 0) break;
    if (!world_ || has_edits_) {
      Result<ReplayedWorld> world = ReplayedWorld::At(run_.recording, *chunk);
      if (!world.ok()) return world.error();
      world_.emplace(std::move(world).value());
    }
    reader_.emplace(run_, *chunk);
    const Result<bool> more = reader_->Next(tick_);
    if (!more.ok()) return more.error();
    if (more.value() && tick_.keyframe && tick_.number <= position) {
      if (Status failure = world_->Restore(tick_); !failure.ok()) return failure;
      position_ = tick_.number;
      Keep();
      return {};
    }
    // Edits take no time: the keyframe may follow the position.
    if (log_time == 0) break;
    --log_time;
  }
  world_.emplace(run_.recording);
  reader_.emplace(run_);
  return {};
}

Status RecordedStates::Advance() {
  const Result<bool> more = reader_->Next(tick_);
  if (!more.ok()) return more.error();
  if (!more.value()) return Error{{}, "found the end of the recording, expected another tick"};
  if (Status problem = world_->Follow(tick_); !problem.ok()) {
    return Error{{}, fmt::format("tick {}: {} (troupe replay tells more)", tick_.tick, problem.error().message)};
  }
  position_ = tick_.number;
  Keep();
  return {};
}

void RecordedStates::Keep() {
  if (kept_.contains(*position_)) return;
  auto state = std::make_shared<ViewedState>(ViewedState{*position_,
                                                         WorldOf(world_->scene()),
                                                         std::make_shared<const WorldState>(world_->state()),
                                                         world_->state_hash(),
                                                         places_[*position_].edition,
                                                         {}});
  if (!tick_.events.empty()) state->events = std::make_shared<const std::vector<Event>>(tick_.events);
  kept_bytes_ += SizeOf(*state);
  kept_.emplace(*position_, std::move(state));
  // The farthest ones are dropped.
  while (kept_bytes_ > kMostKeptBytes && kept_.size() > 1) {
    const bool first = *position_ - kept_.begin()->first > kept_.rbegin()->first - *position_;
    const auto dropped = first ? kept_.begin() : std::prev(kept_.end());
    kept_bytes_ -= SizeOf(*dropped->second);
    kept_.erase(dropped);
  }
}

std::shared_ptr<const ViewedWorld> RecordedStates::WorldOf(const std::shared_ptr<const Scene>& scene) {
  if (newest_world_ != nullptr && newest_scene_.lock() == scene) return newest_world_;
  newest_scene_ = scene;
  const auto same = std::find_if(worlds_.begin(), worlds_.end(),
                                 [&](const auto& world) { return world->scene->world() == scene->world(); });
  if (same == worlds_.end()) {
    SessionMessage session;
    session.run = run_.recording.run().run;
    session.world = scene->world();
    session.world_edition = world_->world_edition();
    worlds_.push_back(shelf_.Of(session));
    newest_world_ = worlds_.back();
  } else {
    newest_world_ = *same;
  }
  return newest_world_;
}

}  // namespace troupe
