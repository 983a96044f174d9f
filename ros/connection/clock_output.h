// ClockOutput: the topic /clock. A thread of its own writes the time of each tick, repeats it while no tick follows, as
// in a pause, and, with a rate, writes the times between two ticks. It takes the speed of the run from
// the instants at which ticks arrive, because an agent is not told it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>

#include "ros/connection/ros_endpoints.h"
#include "ros/messages/ros_options.h"
#include "troupe/ids.h"

namespace troupe::ros {

class ClockOutput {
 public:
  // `rate`: Hz of wall time; 0: only the ticks.
  ClockOutput(const RosNode& node, double rate);
  ~ClockOutput();

  // Writes the time of a committed tick. Time never decreases, unless the tick is an earlier one than that before.
  // `stays`: no tick follows for the time being.
  void Show(Tick tick, std::int64_t interval_ns, bool stays);

 private:
  using WallClock = std::chrono::steady_clock;

  void Run();
  WallClock::time_point NextWrite() const;
  // Simulated time at `now`, ns.
  std::int64_t TimeAt(WallClock::time_point now) const;
  void Write(std::int64_t ns, WallClock::time_point now);
  // `speed`: as of speed_.
  bool Advances(bool stays, std::optional<double> speed) const { return !stays && speed && rate_ > 0.0; }

  RosConnection& connection_;
  const double rate_;
  RosWriter<Clock> writer_;
  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  bool stop_ = false;
  std::optional<double> speed_;  // simulated time of a second of wall time, at the newest ticks; none: not known yet
  bool stays_ = true;
  std::int64_t tick_ns_ = 0;             // time of the newest tick
  std::int64_t interval_ns_ = 0;         // 0: before the first tick
  WallClock::time_point shown_at_ = {};  // when it was shown
  std::int64_t written_ns_ = 0;          // the newest time written
  WallClock::time_point written_at_ = {};
  std::thread thread_;  // last, because it uses all other members
};

}  // namespace troupe::ros
