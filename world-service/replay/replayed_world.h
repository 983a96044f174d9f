// ReplayedWorld: the world of a recorded run, brought from one committed state to the next by the recorded inputs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "recording/recording.h"
#include "troupe/result.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe {

class ReplayedWorld {
 public:
  // At the first state of the run.
  explicit ReplayedWorld(const Recording& recording);
  // As it was at the start of a chunk. The state is not valid before Restore or Follow, but at chunk 0. The error is a
  // damaged recording.
  static Result<ReplayedWorld> At(const Recording& recording, std::size_t chunk);
  ReplayedWorld(const ReplayedWorld&) = default;
  ReplayedWorld(ReplayedWorld&&) = default;

  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  const WorldDescription& world() const { return scene_->world(); }
  const std::shared_ptr<const Scene>& original() const { return original_; }  // that a reset restores
  const WorldState& state() const { return state_; }
  const BodyIndex& bodies() const { return bodies_; }  // at state()
  std::uint64_t state_hash() const { return state_hash_; }
  Edition world_edition() const { return world_edition_; }  // the newest that has changed the description
  Edition edition() const { return edition_; }
  Edition fresh_edition() const { return fresh_edition_; }  // the newest at which all robots were made anew
  // The state as it was published, without the run's id and events.
  FrameMessage Frame() const;
  std::uint64_t number() const { return number_; }  // of the state in the recording
  // The state is one of a rewind before its last, a copy of an earlier one: the run has not published it.
  bool in_rewind() const { return number_ < rewound_until_; }
  // The events of the newest step or edit, in order.
  const std::vector<Event>& events() const { return events_; }

  // Sets the state to that of a tick with a keyframe. The error is a tick without one, or a state from which no step
  // can start.
  Status Restore(const RecordedTick& tick);
  // Steps with the proposals of a recorded tick, or applies its edit. The error is an input that this world refuses;
  // the state is then the one before. REQUIRES: `tick` follows the state.
  Status Apply(const RecordedTick& tick);
  // Applies a recorded edit to the state it was recorded with, so that the steps since the edit before need not be
  // repeated. `number`: of the tick. The error is as in Apply.
  Status ApplyAlone(std::uint64_t number, const RecordedEdit& edit);
  // Goes to the recorded state: by Apply, or by its keyframe if there is no valid state yet. The error is also another
  // state than recorded.
  Status Follow(const RecordedTick& tick);

 private:
  explicit ReplayedWorld(std::shared_ptr<const Scene> scene);
  Status Step(const RecordedTick& tick);
  Status Edit(const RecordedEdit& edit, Edition edition, const WorldState& before);
  void SetState(WorldState state);

  std::shared_ptr<const Scene> original_;  // that a reset restores
  std::shared_ptr<const Scene> scene_;
  bool has_state_ = false;
  WorldState state_;
  std::uint64_t state_hash_ = 0;
  BodyIndex bodies_;
  std::uint64_t number_ = 0;         // of the state in the recording
  std::uint64_t rewound_until_ = 0;  // the number of the state with which the newest rewind ended
  Edition edition_ = 0;
  Edition world_edition_ = 0;
  Edition fresh_edition_ = 0;
  std::vector<Event> events_;
};

// ReplayCursor: a recorded state, and the tick that follows it.
class ReplayCursor {
 public:
  // Before the first state of a chunk. The recording outlives the cursor. The error is a damaged recording.
  static Result<ReplayCursor> At(const Recording& recording, std::size_t chunk);

  const ReplayedWorld& world() const { return world_; }
  // Nothing: the recording ends with the state.
  const std::optional<RecordedTick>& next() const { return next_; }
  // Goes to the state of next(). The error is damage, or another state than recorded, with its tick. REQUIRES: next().
  Status Advance();

 private:
  ReplayCursor(ReplayedWorld world, TickReader reader) : world_(std::move(world)), reader_(std::move(reader)) {}
  Status ReadNext();

  ReplayedWorld world_;
  TickReader reader_;
  std::optional<RecordedTick> next_;
};

// The first difference between two states of one world, for people.

struct StateDifference {
  std::string model;  // its name; "the world" for what belongs to none
  std::string field;  // "x", "heading", "joint position", ...
  std::string found;
  std::string expected;
};

// In the order of the lists of WorldState. Nothing if the states are equal, bit by bit but for the sign of
// zero. REQUIRES: `found` belongs to the world.
std::optional<StateDifference> FindDifference(const WorldDescription& world, const WorldState& found,
                                              const WorldState& expected);

}  // namespace troupe
