// RecordedStates: the states of a recorded run for the viewer. The states on the way to one are kept for some time, so
// that a recording plays backwards as well.
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

#include "recording/partial_recording.h"
#include "troupe/result.h"
#include "viewer/gateway/past_states.h"
#include "world-service/replay/state_reader.h"

namespace troupe {

class RecordedStates final : public Recorded {
 public:
  // Reads all ticks, but steps none. The error is a recording of another version of the step, or one without a
  // readable tick. The shelf outlives the states.
  static Result<std::unique_ptr<RecordedStates>> Create(PartialRecording run, WorldCache& shelf);

  // Why the ticks end early; nothing: they do not.
  const std::optional<std::string>& damage() const { return reader_->damage(); }

  std::optional<Range> range() const override { return Range{0, reader_->places().size() - 1}; }
  std::optional<std::uint64_t> PositionOf(Tick tick) const override { return reader_->PositionOf(tick); }
  Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) override;
  std::vector<TimeSpan> Spans() const override { return spans_.all(); }
  std::deque<NumberedEvent> Events() const override { return events_; }
  RunId run() const override { return reader_->run().recording.run().run; }
  std::uint64_t PositionOf(StatePlace place) const override;
  bool is_whole() const override { return reader_->run().is_whole && !damage(); }

 private:
  explicit RecordedStates(WorldCache& shelf) : shelf_(shelf) {}
  void Keep(const ReplayedWorld& world, const RecordedTick& tick);
  std::shared_ptr<const ViewedWorld> WorldOf(const ReplayedWorld& world);

  WorldCache& shelf_;
  SpanList spans_;  // constant after Create, like the next
  std::deque<NumberedEvent> events_;
  std::unique_ptr<StateReader> reader_;                     // null only until Create has ended
  std::vector<std::shared_ptr<const ViewedWorld>> worlds_;  // all that were shown
  std::weak_ptr<const Scene> newest_scene_;                 // of newest_world_ or another one like it
  std::shared_ptr<const ViewedWorld> newest_world_;
  std::map<std::uint64_t, std::shared_ptr<const ViewedState>> kept_;  // by position
  std::size_t kept_bytes_ = 0;
};

}  // namespace troupe
