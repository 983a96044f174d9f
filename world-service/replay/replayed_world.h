// ReplayedWorld: the world of a recorded run, brought from one committed state to the next by the recorded inputs.
// ReplayCursor: the loop that does so over a recording, and compares each state with the recorded one. Each stepper of
// a recorded run uses it: replays, exports, tests, branches, rewinds, services that continue a run, and
// SteppedTimeline.
//
// A recording is input from outside, also if this program wrote it: every state from which a step is to start is
// checked (CheckStartState), and every proposal and input as if a peer had sent it. So no file can crash a program or
// make a step loop without end.
//
// Copyable by value: a copy continues on its own, and shares the scenes. Not thread-safe; steps run on one thread,
// which gives the same bits as any number of threads.
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
  // Of a run that begins in this world. It has no valid state before Begin or Restore.
  explicit ReplayedWorld(std::shared_ptr<const Scene> scene);
  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  const WorldDescription& world() const { return scene_->world(); }
  const std::shared_ptr<const Scene>& original() const { return original_; }  // that a reset restores
  const WorldState& state() const { return state_; }
  const BodyIndex& bodies() const { return bodies_; }  // at state()
  std::uint64_t state_hash() const { return state_hash_; }
  Edition world_edition() const { return world_edition_; }  // the newest that has changed the description
  Edition edition() const { return edition_; }
  Edition fresh_edition() const { return fresh_edition_; }  // the newest at which all robots were rebuilt
  // The state as it was published, without the run's id and events.
  FrameMessage Frame() const;
  std::uint64_t number() const { return number_; }  // of the state in the recording
  // The state is one of a rewind before its last, a copy of an earlier one: the run has not published it.
  bool in_rewind() const { return number_ < rewound_until_; }
  // The events of the newest step or edit, in order.
  const std::vector<Event>& events() const { return events_; }

  // Sets the state to the first one of the run.
  void Begin();
  // Sets the state to that of a tick with a keyframe. The error is a tick without one, or a state from which no step
  // can start.
  Status Restore(const RecordedTick& tick);
  // Steps with the proposals of a recorded tick, or applies its edit. The error is an input that this world refuses;
  // the state is then the one before. REQUIRES: `tick` follows the state.
  Status Apply(const RecordedTick& tick);
  // Applies a recorded edit to the state it was recorded with, so that the steps since the edit before need not be
  // repeated. `number`: of the tick. The error is as in Apply.
  Status ApplyAlone(std::uint64_t number, const RecordedEdit& edit);

 private:
  Status Step(const RecordedTick& tick);
  Status Edit(const RecordedEdit& edit, Edition edition, const WorldState& before);
  void SetState(WorldState state);

  std::shared_ptr<const Scene> original_;  // that a reset restores
  std::shared_ptr<const Scene> scene_;
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

// A recorded state, and the tick that follows it.
class ReplayCursor {
 public:
  // Why Advance has failed.
  enum class Fault : std::uint8_t {
    kNone,
    kDamage,           // the recorded state is one from which no step can start
    kDifference,       // another state than recorded, or an input that the world refuses
    kNamedDifference,  // a difference whose message names it
  };

  // Nowhere yet: Restart and Approach place it. The recording outlives the cursor.
  explicit ReplayCursor(const Recording& recording)
      : recording_(&recording),
        first_(std::make_shared<const Scene>(recording.run().world)),
        world_(first_),
        reader_(recording) {}
  // Before the first state of a chunk. The error is a damaged recording.
  static Result<ReplayCursor> At(const Recording& recording, std::size_t chunk = 0);
  // At the newest state of a tick; nothing: of the recording. The error is a tick that it does not have, damage, or
  // another state than recorded.
  static Result<ReplayCursor> AtTick(const Recording& recording, const std::optional<Tick>& tick);

  // Goes back, or forward, to before the first state of a chunk.
  Status Restart(std::size_t chunk);

  bool has_state() const { return has_state_; }
  // REQUIRES: has_state(), as for the next two; without a state, chunk 0 has the first one of the run, too.
  const ReplayedWorld& world() const { return world_; }
  const RecordedTick& tick() const { return tick_; }  // that led to the state
  std::uint64_t position() const { return tick_.number; }

  // The tick that follows the state, with its inputs; null: the recording ends with the state. The error is damage.
  // Valid until the next Advance.
  Result<const RecordedTick*> Next();
  // Goes to the state of that tick, and compares it: the hash, a keyframe, and the state before an edit. The error,
  // with the tick, has a fault(). REQUIRES: Next() is a tick.
  Status Advance();
  // Both in one: goes to the next state. False: there is none.
  Result<bool> Step();
  // As far as a position, kEnd: the last state. The error is also a recording that ends before.
  Status StepTo(std::uint64_t position);
  // Goes to where the fewest steps lead to a position: the keyframe before it, or the present state.
  Status Approach(std::uint64_t position);
  Fault fault() const { return fault_; }
  // As Advance, without the comparison.
  Status Apply();

  // "the x of r0 is 1, expected 2": how the state differs from a recorded one; empty: it does not.
  std::string DifferenceFrom(const FrameMessage& recorded) const;

 private:
  Status Compare();
  Status Fail(Fault fault, const std::string& problem);

  const Recording* recording_;
  std::shared_ptr<const Scene> first_;  // of the start of the run
  ReplayedWorld world_;
  TickReader reader_;
  bool begins_run_ = true;  // the world begins the run; false: it needs the state of a keyframe
  bool has_state_ = false;
  bool has_next_ = false;  // that was read
  bool has_ended_ = false;
  bool is_lost_ = false;  // Next or Advance has failed: the world may be in the middle of a tick
  RecordedTick tick_;
  RecordedTick next_;
  Fault fault_ = Fault::kNone;
};

// Refuses a recording that was made with another version of the step.
Status CheckStepVersion(const Recording& recording);
// A recording that this version of the step can step again.
Result<Recording> OpenToReplay(const std::string& path);
Error NoSuchTick(const Recording& recording, Tick tick);
// The events of a tick that a step or an edit repeats, without events of agents.
std::vector<Event> StepEventsOf(const std::vector<Event>& events);

// The state before a recorded one; nothing: there is none.
std::optional<ControllerCheckpoint> PreviousOf(const RecordedTick& tick);

// The first difference between two states of one world, for messages.
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
