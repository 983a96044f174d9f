#include "world-service/replay/state_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

// Stepping on is quicker than starting at a keyframe for at most this many states.
constexpr std::uint64_t kStepOn = 100;

}  // namespace

Result<std::unique_ptr<StateReader>> StateReader::Create(PartialRecording run, const TickVisitor& visit) {
  if (Status other = CheckStepVersion(run.recording); !other.ok()) return other.error();
  std::unique_ptr<StateReader> states(new StateReader(std::move(run)));
  const Recording& recording = states->run_.recording;
  std::optional<std::string>& damage = states->damage_;
  damage = states->ReadPlaces(visit);
  if (!damage && recording.damage()) damage = recording.damage()->problem;
  if (states->places_.empty()) {
    return Error{{recording.name()}, fmt::format("found no tick: {}", damage.value_or("the recording is empty"))};
  }
  return states;
}

std::optional<std::string> StateReader::ReadPlaces(const TickVisitor& visit) {
  RunReader reader(run_);
  RecordedTick tick;
  std::optional<ReplayedWorld> edited;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error().message;
    if (!more.value()) return std::nullopt;
    if (tick.edit) {
      if (!edited) edited.emplace(run_.recording);
      if (Status problem = edited->ApplyAlone(tick.number, *tick.edit); !problem.ok()) return problem.error().message;
    }
    if (visit) visit(tick, places_.size(), edited ? edited->world() : run_.recording.run().world);
    has_edits_ = has_edits_ || tick.edit.has_value();
    // The ticks of a tail have no log time.
    const std::uint64_t before = places_.empty() ? 0 : places_.back().log_time;
    places_.push_back({tick.tick, std::max(tick.log_time, before), tick.edition});
  }
}

std::optional<std::uint64_t> StateReader::PositionOf(Tick tick) const {
  const auto found =
      std::find_if(places_.rbegin(), places_.rend(), [&](const Place& place) { return place.tick == tick; });
  if (found == places_.rend()) return std::nullopt;
  return static_cast<std::uint64_t>(places_.rend() - found) - 1;
}

Status StateReader::Seek(std::uint64_t position, const StateVisitor& visit) {
  if (!position_ || *position_ > position || position - *position_ > kStepOn) {
    if (Status failure = Restart(position); !failure.ok()) return failure;
    if (position_ && visit) visit(*world_, tick_);
  }
  while (!position_ || *position_ < position) {
    if (Status failure = Advance(); !failure.ok()) {
      position_.reset();
      return Error{{run_.recording.name()}, failure.error().message};
    }
    if (visit) visit(*world_, tick_);
  }
  return {};
}

Status StateReader::Restart(std::uint64_t position) {
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

Status StateReader::Advance() {
  const Result<bool> more = reader_->Next(tick_);
  if (!more.ok()) return more.error();
  if (!more.value()) return Error{{}, "found the end of the recording, expected another tick"};
  if (Status problem = world_->Follow(tick_); !problem.ok()) {
    return Error{{}, fmt::format("tick {}: {} (troupe replay tells more)", tick_.tick, problem.error().message)};
  }
  position_ = tick_.number;
  return {};
}

}  // namespace troupe
