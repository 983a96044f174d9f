// The events of a run, and lines for users that are still to be reported.
//
// An event has two readers with different needs. The next frame carries it to agents, recorders and viewers, in an
// order that depends on the run alone; the report to the console or the launcher follows soon, in the order of arrival.
// So an event is kept twice until each reader has drained its copy. Neither influences the state or its hash.
//
// Peers may send any number of rejected proposals and reports, and each would cost memory, a line and bytes of every
// frame: hence a limit on both, with the surplus counted and not lost without a trace.
//
// Not thread-safe: both classes belong to the coordinator, and are called under its lock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "troupe/event.h"
#include "troupe/world_description.h"

namespace troupe {

// The events of the next frame, and those that were not reported yet.
class EventLog {
 public:
  // An event between two frames; `tick` is the newest one committed.
  void Add(EventType type, Tick tick, std::optional<RobotId> robot, std::string detail);

  // A proposal was rejected. All are counted; of more than ten in a second, the others are reported as one sum, so that
  // a hostile peer cannot hide other events. Returns whether this one is reported itself.
  bool Reject(Tick tick, std::optional<RobotId> robot, std::string reason, double now);

  // An agent reports a line: a plain one of at most kMaxReport bytes. Drops it when many are waiting: a hostile
  // peer may send any number in a tick.
  void Report(Tick tick, std::optional<RobotId> robot, std::string_view text);

  // Returns the events of frame `tick`: the events since the previous frame, by robot, then the events of the step.
  std::vector<Event> CompleteFrame(Tick tick, std::vector<Event> of_step);

  // The events that were not returned before, in their order.
  std::vector<Event> DrainUnreported();

  // The last that the robot's controller has said (kSaid), in a frame so far; null: nothing.
  const Event* LastSaid(RobotId robot) const;

  // An edit has changed the meaning of ids: no event from before enters a frame.
  void DiscardPending() {
    between_frames_.clear();
    said_.clear();
    reports_between_frames_ = 0;
  }

  // Restores the counts so far of a run that is continued.
  void RestoreCounts(std::uint64_t stalls, std::uint64_t rejected) {
    stalls_ = stalls;
    rejected_ = rejected;
  }
  std::uint64_t stalls() const { return stalls_; }
  std::uint64_t rejected() const { return rejected_; }

 private:
  static constexpr std::size_t kMaxReports = 100;  // of a frame, and of those that were not reported yet
  static constexpr std::size_t kMaxReport = 1000;

  std::vector<Event> between_frames_;
  std::vector<Event> unreported_;
  std::map<RobotId, Event> said_;
  std::size_t reports_between_frames_ = 0;  // of between_frames_, as the next
  std::size_t unreported_reports_ = 0;
  std::uint64_t stalls_ = 0;
  std::uint64_t rejected_ = 0;
  double second_began_ = 0.0;  // wall time, of the rejections counted below
  int rejected_this_second_ = 0;
  std::uint64_t silent_ = 0;  // rejections that only the next sum reports
};

// Any other lines for users.
class NoticeList {
 public:
  void Add(std::string text) { notices_.push_back(std::move(text)); }
  // A plain line of at most kMaxLength bytes. Drops the notice when many are waiting: a hostile peer may cause any
  // number between two reports.
  void AddFromPeer(std::string_view text) {
    if (notices_.size() < kMax) Add(PlainLine(text, kMaxLength));
  }
  // The notices that were not returned before.
  std::vector<std::string> Drain() { return std::exchange(notices_, {}); }

 private:
  static constexpr std::size_t kMax = 100;
  static constexpr std::size_t kMaxLength = 1000;

  std::vector<std::string> notices_;
};

// Events as text for users, and in JSON.

// One line, for instance "tick 12: r0 stalled at table.leg". REQUIRES: the event's ids are of this world.
std::string EventText(const WorldDescription& world, const Event& event);

// An event as it is told to users, with the line about it.
struct ToldEvent {
  Event event;
  std::string text;
};
// In the order of the events. The joins and losses of an agent with many robots are one line; of many such agents the
// first ten have a line, and the others one with the number of their robots. REQUIRES: the ids are of this world.
std::vector<ToldEvent> ToldEvents(const WorldDescription& world, const std::vector<Event>& events);

// {"event": "stall_began", "robot": "r0", "other": "wall"}: the type of the event and the names of its participants, as
// far as it has them. Without its tick and detail. REQUIRES: the event's ids are of this world.
nlohmann::json EventJson(const WorldDescription& world, const Event& event);

// A JSON object as text: {"detail": "", "event": "stall_began", "other": "wall", "robot": "r0", "tick": 7}.
// REQUIRES: the event's ids are of this world.
std::string EventLine(const WorldDescription& world, const Event& event);

}  // namespace troupe
