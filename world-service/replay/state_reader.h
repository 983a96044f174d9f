// StateReader: the states of a recorded run by their positions, which count from 0: a tick may be repeated after edits.
// A state is stepped again from the keyframe before it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "recording/partial_recording.h"
#include "troupe/result.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

class StateReader {
 public:
  struct Place {
    Tick tick = 0;
    std::uint64_t log_time = 0;
    Edition edition = 0;
  };
  // Called with each tick in its order, its position and the world of its events.
  using TickVisitor =
      std::function<void(const RecordedTick& tick, std::uint64_t position, const WorldDescription& world)>;
  // Called with each state on the way to a position, and its tick: a reader that goes backwards may keep it.
  using StateVisitor = std::function<void(const ReplayedWorld& world, const RecordedTick& tick)>;

  // Reads all ticks, but steps none. The error is a recording of another version of the step, or one without a readable
  // tick.
  static Result<std::unique_ptr<StateReader>> Create(PartialRecording run, const TickVisitor& visit = {});
  StateReader(const StateReader&) = delete;
  StateReader& operator=(const StateReader&) = delete;

  const PartialRecording& run() const { return run_; }
  // Why the ticks end early; nothing: they do not.
  const std::optional<std::string>& damage() const { return damage_; }
  const std::vector<Place>& places() const { return places_; }  // by position, not empty
  // The newest state of a tick; nothing: there is none.
  std::optional<std::uint64_t> PositionOf(Tick tick) const;

  // Brings the world to a position. The error is damage, or another state than recorded; the next call starts anew.
  // REQUIRES: the position exists.
  Status Seek(std::uint64_t position, const StateVisitor& visit = {});
  // At the position of the last Seek. REQUIRES: it has succeeded.
  const ReplayedWorld& world() const { return *world_; }
  const RecordedTick& tick() const { return tick_; }

 private:
  explicit StateReader(PartialRecording run) : run_(std::move(run)) {}
  std::optional<std::string> ReadPlaces(const TickVisitor& visit);
  // Brings the world to the last keyframe before a position, or before the first state.
  Status Restart(std::uint64_t position);
  Status Advance();

  const PartialRecording run_;
  std::optional<std::string> damage_;  // constant after Create, like the next two
  std::vector<Place> places_;
  bool has_edits_ = false;  // then the world is not the same in all states
  std::optional<ReplayedWorld> world_;
  std::optional<RunReader> reader_;
  std::optional<std::uint64_t> position_;  // of world_; nothing: it has no state yet
  RecordedTick tick_;
};

}  // namespace troupe
