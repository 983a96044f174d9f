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

// The worlds that viewers have, so that a past state has the same one as a live state: a page builds each anew.
//
// Threads: any.
class WorldCache {
 public:
  // The world of a session, made if no viewer can have it.
  std::shared_ptr<const ViewedWorld> Of(const SessionMessage& session);

 private:
  std::mutex mutex_;  // guards the others
  std::vector<std::weak_ptr<const ViewedWorld>> worlds_;
  std::uint32_t made_ = 0;
};

// A committed state of a run, with the world that it belongs to.
struct ViewedState {
  std::uint64_t position = 0;
  std::shared_ptr<const ViewedWorld> world;
  std::shared_ptr<const WorldState> state;
  std::uint64_t state_hash = 0;
  Edition edition = 0;
  std::shared_ptr<const std::vector<Event>> events = {};  // of its tick; null: none
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
inline constexpr std::size_t kEventsKept = 10'000;  // for viewers, the newest

// A part of the timeline without a gap, in which ticks count up with positions. Another one begins after an edit that
// sets the time back, and where states are missing.
struct TimeSpan {
  std::uint64_t first = 0;  // position
  std::uint64_t last = 0;
  Tick tick = 0;  // at the first
  bool operator==(const TimeSpan&) const = default;
};

// The spans of the states that are added.
class SpanList {
 public:
  // Positions ascend.
  void Add(std::uint64_t position, Tick tick);
  void DropBefore(std::uint64_t position);
  void Clear() { spans_.clear(); }
  const std::vector<TimeSpan>& all() const { return spans_; }

 private:
  std::vector<TimeSpan> spans_;  // ascending
};

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
  // Of the states that there are, ascending. On any thread, too.
  virtual std::vector<TimeSpan> Spans() const = 0;

  // The state at a position, or at the nearest that there is. The call may take some time. Called on one thread. The
  // error is a state that cannot be read.
  virtual Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) = 0;
};

// A recorded run: all of its states are in the past.
class Recorded : public PastStates {
 public:
  using PastStates::PositionOf;
  // In their order, at most the newest kEventsKept.
  virtual std::deque<NumberedEvent> Events() const = 0;
  virtual RunId run() const = 0;
  // Of a state of the run, also of one after the last that is recorded here.
  virtual std::uint64_t PositionOf(StatePlace place) const = 0;
  // The run has ended, and nothing of it is missing.
  virtual bool is_whole() const = 0;
};

// The newest states of a live run, in a bounded memory. A position counts the ticks, too, that were not received.
//
// Threads: any; Add on one.
class KeptStates final : public PastStates {
 public:
  explicit KeptStates(std::size_t bytes) : most_bytes_(bytes) {}

  // Appends a state, whose position is set, and drops the oldest ones that are too many. Returns it.
  std::shared_ptr<const ViewedState> Add(ViewedState state);
  void Clear();
  // The position of the next state, which is the first. REQUIRES: there is none.
  void SetNext(std::uint64_t position);

  std::optional<Range> range() const override;
  std::optional<std::uint64_t> PositionOf(Tick tick) const override;
  Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) override;
  std::vector<TimeSpan> Spans() const override;

 private:
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;                               // guards the others
  std::deque<std::shared_ptr<const ViewedState>> states_;  // by position, with gaps
  SpanList spans_;
  std::size_t bytes_ = 0;
  std::uint64_t next_ = 0;  // position of the next one, if no tick is missing
};

// The past of a live run: the states that were received, and those that its journal has beside them.
//
// Threads: as PastStates.
class RunPast final : public PastStates {
 public:
  explicit RunPast(std::size_t bytes) : kept_(bytes) {}

  KeptStates& kept() { return kept_; }
  // Null: none.
  void SetRecorded(std::shared_ptr<Recorded> recorded);
  std::shared_ptr<Recorded> recorded() const;

  std::optional<Range> range() const override;
  std::optional<std::uint64_t> PositionOf(Tick tick) const override;
  Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) override;
  std::vector<TimeSpan> Spans() const override;

 private:
  KeptStates kept_;
  mutable std::mutex mutex_;  // guards the next
  std::shared_ptr<Recorded> recorded_;
};

}  // namespace troupe
