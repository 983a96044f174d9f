// Timeline: the past of a run, live or recorded, as a sequence of states. A state is named by its position, which
// counts the states from the first on, because a tick may be repeated after edits.
//
// Whatever shows or judges the past (pages, plots, verdicts, pictures, tables of Python) is written against this
// interface. It has two implementations: RunFeed (viewer/gateway) has the received states of a live run, and before
// them the states of its journal; SteppedTimeline (world-service/replay) steps the states of a recording again, from
// its keyframes and inputs.
//
// Invariants: positions ascend without repeats; within a TimeSpan, ticks count up with positions; spans neither overlap
// nor touch unless ticks jump. A state never changes once it has been returned, and is shared, so that any number of
// threads may keep it; a world is one object for all of its states (WorldCache).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

// The world of some states of a run.
struct TimelineWorld {
  std::uint32_t number = 0;  // counts the worlds of a cache from 1
  RunId run = 0;
  Edition edition = 0;                         // that made it
  std::shared_ptr<const std::string> message;  // for viewers, as the cache encodes it; null: it does not
  std::shared_ptr<const Scene> scene;

  const WorldDescription& description() const { return scene->world(); }
};

// The worlds in use, each once: a live state and a past one of the same world have the same object, so that nothing is
// built again for the other.
//
// Threads: any.
class WorldCache {
 public:
  using Encode = std::function<std::string(const SessionMessage& session, std::uint32_t number)>;
  explicit WorldCache(Encode encode = {}) : encode_(std::move(encode)) {}

  // The world of a session, made unless one of the same run, edition and description is in use.
  // `scene`: of the session's world; null: it is made if it is needed.
  std::shared_ptr<const TimelineWorld> Of(const SessionMessage& session, std::shared_ptr<const Scene> scene = nullptr);

 private:
  const Encode encode_;
  std::mutex mutex_;  // guards the others
  std::vector<std::weak_ptr<const TimelineWorld>> worlds_;
  std::uint32_t made_ = 0;
};

// A committed state of a run, with the world that it belongs to.
struct TimelineState {
  std::uint64_t position = 0;
  std::shared_ptr<const TimelineWorld> world;
  std::shared_ptr<const WorldState> state;
  std::uint64_t state_hash = 0;
  Edition edition = 0;
  std::shared_ptr<const std::vector<Event>> events = {};  // of its tick; null: none
};
using SharedState = std::shared_ptr<const TimelineState>;

// About as many bytes as it takes, without its world.
std::size_t SizeOf(const TimelineState& state);

// The names of the robot and models of an event. Empty: it has none.
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
  EventNames names;  // in the world of the event: after an edit its ids may belong to others
};
inline constexpr std::size_t kEventsKept = 10'000;  // of a timeline, the newest

// A part of a timeline without a gap, in which ticks count up with positions. Another one begins with each edit, and
// where states are missing.
struct TimeSpan {
  std::uint64_t first = 0;  // position
  std::uint64_t last = 0;
  Tick tick = 0;  // at the first
  Edition edition = 0;
  bool operator==(const TimeSpan&) const = default;
};

class TimeSpans {
 public:
  TimeSpans() = default;
  // Ascending, without an overlap.
  explicit TimeSpans(std::vector<TimeSpan> spans) : spans_(std::move(spans)) {}

  const std::vector<TimeSpan>& all() const { return spans_; }
  bool empty() const { return spans_.empty(); }
  // The ends. REQUIRES: !empty()
  std::uint64_t first() const { return spans_.front().first; }
  std::uint64_t last() const { return spans_.back().last; }

  // The first and the newest state of a tick; nothing: there is none.
  std::optional<std::uint64_t> First(Tick tick) const;
  std::optional<std::uint64_t> Last(Tick tick) const;
  Tick greatest() const;  // REQUIRES: !empty()
  // REQUIRES: a state has the position.
  Tick TickAt(std::uint64_t position) const;
  // The position of a state, also of one after the last or in a gap: ticks and editions count up.
  std::uint64_t PositionOf(StatePlace place) const;
  // The first state of an edition, or of a later one; behind the last: there is none.
  std::uint64_t BeginOf(Edition edition) const;

  // Adds a state, or the part of a span behind the last position.
  void Add(std::uint64_t position, Tick tick, Edition edition) { Append({position, position, tick, edition}); }
  void Append(TimeSpan span);
  void DropBefore(std::uint64_t position);
  void DropAfter(std::uint64_t position);
  void Clear() { spans_.clear(); }

 private:
  std::vector<TimeSpan> spans_;
};

// States in a bounded memory: the states farthest from the newest addition are dropped.
class KeptStates {
 public:
  explicit KeptStates(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  // The state that was added last stays, whatever its size.
  void Add(SharedState state);
  void Clear();
  bool empty() const { return states_.empty(); }
  // The ends. REQUIRES: !empty()
  std::uint64_t first() const { return states_.begin()->first; }
  const SharedState& last() const { return states_.rbegin()->second; }
  // Null: it is not kept.
  SharedState Find(std::uint64_t position) const;
  // At the position or the nearest before it, or else the first. REQUIRES: !empty()
  SharedState Nearest(std::uint64_t position) const;

 private:
  const std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::map<std::uint64_t, SharedState> states_;  // by position
};

class Timeline {
 public:
  virtual ~Timeline() = default;

  // The states that there are. On any thread.
  virtual std::shared_ptr<const TimeSpans> Spans() const = 0;

  // The state at a position, or at the nearest that there is. The call may take some time. On one thread. The error is
  // a state that cannot be read, or a timeline without a state.
  virtual Result<SharedState> At(std::uint64_t position) = 0;

  // The newest state by VDA 5050 that the robot of that name had sent at a position, as it was sent; empty: none. On
  // the thread of At. The error is damage.
  virtual Result<std::string> VehicleStateAt(const std::string& robot, std::uint64_t position) {
    static_cast<void>(robot);
    static_cast<void>(position);
    return std::string();
  }
};

// A recorded run, as far as it has come: it has at least one state, and its spans are constant.
class RecordedTimeline : public Timeline {
 public:
  // In their order, at most the newest kEventsKept.
  virtual const std::deque<NumberedEvent>& Events() const = 0;
  virtual RunId run() const = 0;
  // The run has ended, and nothing of it is missing.
  virtual bool is_whole() const = 0;
};

}  // namespace troupe
