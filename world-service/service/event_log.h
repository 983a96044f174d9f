// EventLog: the events that go into the next frame, and those that the run's observer has not been told yet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/model/event.h"

namespace troupe {

class EventLog {
 public:
  // Something happened between two frames; `tick` is the newest one committed.
  void Add(EventType type, Tick tick, std::optional<RobotId> robot, std::string detail);

  // A proposal was rejected. All are counted; of more than ten in a second, the others are told as one sum, so that a
  // hostile peer cannot drown the rest.
  void Reject(Tick tick, std::optional<RobotId> robot, std::string reason, double now);

  // The events of frame `tick`: what happened since the frame before, by robot, then what the step returned.
  std::vector<Event> TakeForFrame(Tick tick, std::vector<Event> of_step);

  // Events that were not returned before, in the order in which they happened.
  std::vector<Event> TakeUntold();

  // An edit has made ids mean something else: nothing of before goes into a frame.
  void Forget() { between_frames_.clear(); }

  std::uint64_t stalls() const { return stalls_; }
  std::uint64_t rejected() const { return rejected_; }

 private:
  std::vector<Event> between_frames_;
  std::vector<Event> untold_;
  std::uint64_t stalls_ = 0;
  std::uint64_t rejected_ = 0;
  double second_began_ = 0.0;  // wall time, of the rejections counted below
  int rejected_this_second_ = 0;
  std::uint64_t silent_ = 0;  // rejections that only the next sum tells
};

}  // namespace troupe
