// SteppedTimeline: a recorded run as a timeline, whose states are stepped again from the keyframes and the inputs, and
// compared with the recorded hashes. The states on the way to one are kept for some time, so that a recording plays
// backwards as well.
//
// Why states are stepped and not stored: a recording of inputs is a hundredth of the size of its states, and a state
// that was stepped is known to be right by its hash. The price is up to a keyframe interval of steps for a jump.
//
// Threads: At on one, the others on any. Memory: kMaxKeptBytes of states, and all worlds that were shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "recording/timeline/timeline.h"
#include "troupe/result.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {

class SteppedTimeline final : public RecordedTimeline {
 public:
  static constexpr std::size_t kMaxKeptBytes = std::size_t{128} << 20;

  // Reads all ticks, but steps none. The error is a recording of another version of the step, or one without a readable
  // tick. The cache outlives the timeline.
  static Result<std::unique_ptr<SteppedTimeline>> Create(Recording recording, WorldCache& worlds,
                                                         std::size_t max_kept_bytes = kMaxKeptBytes);
  SteppedTimeline(const SteppedTimeline&) = delete;
  SteppedTimeline& operator=(const SteppedTimeline&) = delete;

  const Recording& recording() const { return recording_; }
  // Why the states end early; nothing: they do not.
  const std::optional<std::string>& damage() const { return damage_; }

  std::shared_ptr<const TimeSpans> Spans() const override { return spans_; }
  // The error is damage, or another state than recorded; the next call begins at a keyframe again.
  Result<SharedState> At(std::uint64_t position) override;
  const std::deque<NumberedEvent>& Events() const override { return events_; }
  RunId run() const override { return recording_.run().run; }
  bool is_whole() const override { return !damage_; }
  Result<std::string> VehicleStateAt(const std::string& robot, std::uint64_t position) override;

 private:
  SteppedTimeline(Recording recording, WorldCache& worlds, std::size_t max_kept_bytes)
      : recording_(std::move(recording)), worlds_(worlds), kept_(max_kept_bytes) {}
  // Finds the spans and the events. Returns the damage at which the ticks end.
  std::optional<std::string> ReadTicks();
  // Goes to a position, and keeps the states on the way.
  Status Seek(std::uint64_t position);
  void Keep();
  std::shared_ptr<const TimelineWorld> WorldOf(const ReplayedWorld& replayed);

  const Recording recording_;
  WorldCache& worlds_;
  std::optional<std::string> damage_;  // constant after Create, as the next three
  std::shared_ptr<const TimeSpans> spans_;
  std::deque<NumberedEvent> events_;
  struct SentState {
    std::uint64_t number = 0;  // of the tick
    RobotId robot;             // in its world
  };
  std::map<std::string, std::vector<SentState>> vehicle_states_;  // by robot; where the texts are, which may be large
  std::optional<ReplayCursor> cursor_;                            // nothing: none yet
  KeptStates kept_;
  std::vector<std::shared_ptr<const TimelineWorld>> were_shown_;  // in use as long as the timeline
  std::weak_ptr<const Scene> newest_scene_;                       // of newest_world_, or another one like it
  std::shared_ptr<const TimelineWorld> newest_world_;
};

}  // namespace troupe
