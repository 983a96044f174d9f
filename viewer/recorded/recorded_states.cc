#include "viewer/recorded/recorded_states.h"

#include <algorithm>
#include <utility>

namespace troupe {
namespace {

constexpr std::size_t kMaxKeptBytes = std::size_t{128} << 20;

}  // namespace

Result<std::unique_ptr<RecordedStates>> RecordedStates::Create(PartialRecording run, WorldCache& shelf) {
  std::unique_ptr<RecordedStates> states(new RecordedStates(shelf));
  std::uint64_t count = 0;
  Result<std::unique_ptr<StateReader>> reader = StateReader::Create(
      std::move(run), [&](const RecordedTick& tick, std::uint64_t position, const WorldDescription& world) {
        for (const Event& event : tick.events) {
          states->events_.push_back({++count, position, event, NamesIn(world, event)});
          if (states->events_.size() > kEventsKept) states->events_.pop_front();
        }
        states->spans_.Add(position, tick.tick);
      });
  if (!reader.ok()) return reader.error();
  states->reader_ = std::move(reader).value();
  return states;
}

std::uint64_t RecordedStates::PositionOf(StatePlace place) const {
  const std::vector<StateReader::Place>& places = reader_->places();
  const auto after = std::partition_point(places.begin(), places.end(), [&](const StateReader::Place& known) {
    return StatePlace{known.edition, known.tick} <= place;
  });
  if (after == places.begin()) return 0;
  const StateReader::Place& before = *std::prev(after);
  const auto position = static_cast<std::uint64_t>(after - places.begin()) - 1;
  const bool is_same_edition = before.edition == place.edition;
  return position + (is_same_edition ? place.tick - before.tick : std::uint64_t{place.edition - before.edition});
}

Result<std::shared_ptr<const ViewedState>> RecordedStates::At(std::uint64_t position) {
  position = std::min<std::uint64_t>(position, reader_->places().size() - 1);
  if (const auto kept = kept_.find(position); kept != kept_.end()) return kept->second;
  Status failure = reader_->Seek(position, [this](const auto& world, const auto& tick) { Keep(world, tick); });
  if (!failure.ok()) return failure.error();
  if (const auto kept = kept_.find(position); kept != kept_.end()) return kept->second;
  Keep(reader_->world(), reader_->tick());
  return kept_.at(position);
}

void RecordedStates::Keep(const ReplayedWorld& world, const RecordedTick& tick) {
  const std::uint64_t position = world.number();
  if (kept_.contains(position)) return;
  auto state = std::make_shared<ViewedState>(ViewedState{position,
                                                         WorldOf(world),
                                                         std::make_shared<const WorldState>(world.state()),
                                                         world.state_hash(),
                                                         reader_->places()[position].edition,
                                                         {}});
  if (!tick.events.empty()) state->events = std::make_shared<const std::vector<Event>>(tick.events);
  kept_bytes_ += SizeOf(*state);
  kept_.emplace(position, std::move(state));
  // The farthest ones are dropped.
  while (kept_bytes_ > kMaxKeptBytes && kept_.size() > 1) {
    const bool first = position - kept_.begin()->first > kept_.rbegin()->first - position;
    const auto dropped = first ? kept_.begin() : std::prev(kept_.end());
    kept_bytes_ -= SizeOf(*dropped->second);
    kept_.erase(dropped);
  }
}

std::shared_ptr<const ViewedWorld> RecordedStates::WorldOf(const ReplayedWorld& replayed) {
  const std::shared_ptr<const Scene>& scene = replayed.scene();
  if (newest_world_ != nullptr && newest_scene_.lock() == scene) return newest_world_;
  newest_scene_ = scene;
  const auto same = std::find_if(worlds_.begin(), worlds_.end(),
                                 [&](const auto& world) { return world->scene->world() == scene->world(); });
  if (same == worlds_.end()) {
    SessionMessage session;
    session.run = run();
    session.world = troupe::WorldOf(scene);
    session.scene = scene;
    session.world_edition = replayed.world_edition();
    worlds_.push_back(shelf_.Of(session));
    newest_world_ = worlds_.back();
  } else {
    newest_world_ = *same;
  }
  return newest_world_;
}

}  // namespace troupe
