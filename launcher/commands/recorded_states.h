// RecordedStates: the states of a recording for the viewer. A state is stepped again from the keyframe before it; the
// states in between are kept for some time, so that a recording plays backwards as well.
//
// Threads: At on one, the others on any.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "recording/recording.h"
#include "recording/tick_reader.h"
#include "viewer/gateway/past_states.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

class RecordedStates final : public Recorded {
 public:
  // Reads all ticks, but steps none. The recording outlives the states. The error is a recording of another version of
  // the step, or one without a readable tick. `damage`: why the ticks end early; nothing: they do not.
  static Result<std::unique_ptr<RecordedStates>> Create(const Recording& recording, std::optional<std::string>& damage);

  std::optional<Range> range() const override { return Range{0, places_.size() - 1}; }
  std::optional<std::uint64_t> PositionOf(Tick tick) const override;
  Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) override;
  std::vector<NumberedEvent> Events() const override { return events_; }

 private:
  struct Place {
    Tick tick = 0;
    std::uint64_t log_time = 0;
    Edition edition = 0;
  };

  explicit RecordedStates(const Recording& recording) : recording_(recording) {}
  std::optional<std::string> ReadPlaces();
  // Brings the world to the last keyframe before a position, or to the begin.
  Status Restart(std::uint64_t position);
  // Applies the next tick, and keeps its state.
  Status Advance();
  void Keep();
  std::shared_ptr<const ViewedWorld> WorldOf(const std::shared_ptr<const Scene>& scene);

  const Recording& recording_;
  std::vector<Place> places_;  // by position; constant after Create, like the next
  std::vector<NumberedEvent> events_;
  bool has_edits_ = false;  // then the world is not the same in all states

  std::optional<ReplayedWorld> world_;
  std::optional<TickReader> reader_;
  std::optional<std::uint64_t> position_;  // of world_; nothing: it has no state yet
  RecordedTick tick_;
  std::vector<std::shared_ptr<const ViewedWorld>> worlds_;  // all that were shown
  std::weak_ptr<const Scene> newest_scene_;                 // of worlds_.back() or another one like it
  std::shared_ptr<const ViewedWorld> newest_world_;
  std::map<std::uint64_t, std::shared_ptr<const ViewedState>> kept_;  // by position
  std::size_t kept_bytes_ = 0;
};

}  // namespace troupe
