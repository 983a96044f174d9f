// RecordedStates: the states of a recorded run for the viewer. A state is stepped again from the keyframe before it;
// the states in between are kept for some time, so that a recording plays backwards as well.
//
// Threads: At on one, the others on any.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "recording/run_so_far.h"
#include "troupe/result.h"
#include "viewer/gateway/past_states.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

class RecordedStates final : public Recorded {
 public:
  // Reads all ticks, but steps none. The error is a recording of another version of the step, or one without a
  // readable tick. The shelf outlives the states.
  static Result<std::unique_ptr<RecordedStates>> Create(RunSoFar run, WorldShelf& shelf);

  // Why the ticks end early; nothing: they do not.
  const std::optional<std::string>& damage() const { return damage_; }

  std::optional<Range> range() const override { return Range{0, places_.size() - 1}; }
  std::optional<std::uint64_t> PositionOf(Tick tick) const override;
  Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) override;
  std::vector<TimeSpan> Spans() const override { return spans_.all(); }
  std::deque<NumberedEvent> Events() const override { return events_; }
  RunId run() const override { return run_.recording.run().run; }
  std::uint64_t PositionOf(StatePlace place) const override;
  bool is_whole() const override { return run_.is_whole && !damage_; }

 private:
  struct Place {
    Tick tick = 0;
    std::uint64_t log_time = 0;
    Edition edition = 0;
  };

  RecordedStates(RunSoFar run, WorldShelf& shelf) : run_(std::move(run)), shelf_(shelf) {}
  std::optional<std::string> ReadPlaces();
  // Brings the world to the last keyframe before a position, or to the start.
  Status Restart(std::uint64_t position);
  // Applies the next tick, and keeps its state.
  Status Advance();
  void Keep();
  std::shared_ptr<const ViewedWorld> WorldOf(const std::shared_ptr<const Scene>& scene);

  const RunSoFar run_;
  WorldShelf& shelf_;
  std::optional<std::string> damage_;  // constant after Create, like the next
  std::vector<Place> places_;          // by position
  SpanList spans_;
  std::deque<NumberedEvent> events_;
  bool has_edits_ = false;  // then the world is not the same in all states

  std::optional<ReplayedWorld> world_;
  std::optional<RunReader> reader_;
  std::optional<std::uint64_t> position_;  // of world_; nothing: it has no state yet
  RecordedTick tick_;
  std::vector<std::shared_ptr<const ViewedWorld>> worlds_;  // all that were shown
  std::weak_ptr<const Scene> newest_scene_;                 // of newest_world_ or another one like it
  std::shared_ptr<const ViewedWorld> newest_world_;
  std::map<std::uint64_t, std::shared_ptr<const ViewedState>> kept_;  // by position
  std::size_t kept_bytes_ = 0;
};

}  // namespace troupe
