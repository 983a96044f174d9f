// ReplayedWorld: the world of a recorded run, brought from one committed state to the next by the recorded inputs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/recording/recording.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

namespace troupe {

class ReplayedWorld {
 public:
  // At the first state of the run.
  explicit ReplayedWorld(const Recording& recording);
  // As it was at the begin of a chunk. The state is not valid before Restore. The error is a damaged recording.
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
  // Of the newest step or edit, in order.
  const std::vector<Event>& events() const { return events_; }

  // Sets the state to a recorded one of this world. The error is a state from which no step can start.
  Status Restore(const FrameMessage& keyframe);
  // Steps with the proposals of a recorded tick, or applies its edit. The error is an input that this world refuses;
  // the state is then the one before. REQUIRES: `tick` follows the state.
  Status Apply(const RecordedTick& tick);

 private:
  explicit ReplayedWorld(std::shared_ptr<const Scene> scene);
  Status Step(const RecordedTick& tick);
  Status Edit(const RecordedEdit& edit, Edition edition, const WorldState& before);
  void SetState(WorldState state);

  std::shared_ptr<const Scene> original_;  // that a reset restores
  std::shared_ptr<const Scene> scene_;
  WorldState state_;
  std::uint64_t state_hash_ = 0;
  BodyIndex bodies_;
  Edition edition_ = 0;
  Edition world_edition_ = 0;
  Edition fresh_edition_ = 0;
  std::vector<Event> events_;
};

}  // namespace troupe
