// PastStates: the states of a run that viewers can go back to, in their order: those that the gateway has seen of a
// live run (KeptStates), or all of a recording.
//
// A state is named by its position, which counts the states from the first on: a tick may be repeated after edits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

// The world of an edition, prepared for viewers.
struct ViewedWorld {
  std::uint32_t number = 0;  // counts the worlds of a feed or a recording from 1
  RunId run = 0;
  Edition edition = 0;                         // world_edition of its frames
  std::shared_ptr<const std::string> message;  // EncodeWorld
  std::shared_ptr<const Scene> scene;

  const WorldDescription& description() const { return scene->world(); }
};

// Makes the message and the scene.
std::shared_ptr<const ViewedWorld> MakeViewedWorld(const SessionMessage& session, std::uint32_t number);

// A committed state of a run, with the world that it belongs to.
struct ViewedState {
  std::uint64_t position = 0;
  std::shared_ptr<const ViewedWorld> world;
  std::shared_ptr<const WorldState> state;
  std::uint64_t state_hash = 0;
  Edition edition = 0;
};

// About as many bytes as it takes, without its world.
std::size_t SizeOf(const ViewedState& state);

// The names of what an event is about. Empty: nothing.
struct EventNames {
  std::string robot;
  std::string other;
  std::string object;
};
EventNames NamesIn(const WorldDescription& world, const Event& event);

struct NumberedEvent {
  std::uint64_t number = 0;    // counts the events of a run or a recording from 1
  std::uint64_t position = 0;  // of its state
  Event event;
  EventNames names;  // in the world of the event: its ids may be those of others after an edit
};
inline constexpr std::size_t kEventsKept = 500;  // for viewers

class PastStates {
 public:
  struct Range {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    bool operator==(const Range&) const = default;
  };

  virtual ~PastStates() = default;

  // Both may be called on any thread. Nothing: there is no state (of that tick).
  virtual std::optional<Range> range() const = 0;
  virtual std::optional<std::uint64_t> PositionOf(Tick tick) const = 0;  // the newest one

  // The state at a position, or at the nearest that there is. The call may take some time. Called on one thread. The
  // error is a state that cannot be read.
  virtual Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) = 0;
};

// A recording: all of its states are in the past.
class Recorded : public PastStates {
 public:
  // In their order, at most the first kEventsKept.
  virtual std::vector<NumberedEvent> Events() const = 0;
};

// The newest states of a live run, in a bounded memory.
//
// Threads: any; Add on one.
class KeptStates final : public PastStates {
 public:
  explicit KeptStates(std::size_t bytes) : most_bytes_(bytes) {}

  // Appends a state, whose position is set, and drops the oldest ones that are too many. Returns it.
  std::shared_ptr<const ViewedState> Add(ViewedState state);
  void Clear();

  std::optional<Range> range() const override;
  std::optional<std::uint64_t> PositionOf(Tick tick) const override;
  Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) override;

 private:
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;  // guards the others
  std::deque<std::shared_ptr<const ViewedState>> states_;
  std::size_t bytes_ = 0;
  std::uint64_t next_ = 0;  // position of the next one
};

}  // namespace troupe
