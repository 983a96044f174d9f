// ClockOutput: the topic /clock. A thread of its own writes the time of each tick, repeats it while no tick follows, as
// in a pause, and, with a rate, writes the times between two ticks. It takes the speed of the run from the instants at
// which ticks arrive, because an agent does not know it.
// Between two ticks its times only grow, and none is beyond the tick that follows; only a reset turns it back: nodes
// with use_sim_time run their timers by it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/spatial/scene.h"
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
  // The times up to the next tick are written.
  bool AwaitsTick() const { return written_ns_ >= tick_ns_ + interval_ns_; }

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

// Writes the section of the static bodies that the topics ask for.
void WriteMap(RosWriter<OccupancyGridMessage>& writer, const Scene& scene, const WorldTopics& topics);

// MapOutput: the topic /map in the ROS domain of a single robot. A thread makes it once it has a reader, and then ends.
class MapOutput {
 public:
  MapOutput(const RosNode& node, const WorldTopics& topics);
  ~MapOutput();

  // The static bodies have changed. REQUIRES: the scene outlives the output, or the next call.
  void ChangeWorld(const Scene& scene);
  // Call now and then.
  void Poll();

 private:
  void Join();

  RosConnection& connection_;
  const WorldTopics topics_;
  RosWriter<OccupancyGridMessage> map_;
  const Scene* scene_ = nullptr;
  std::atomic<bool> written_ = false;
  std::thread thread_;  // last, because it uses all other members
};

enum class LogLevel : std::uint8_t { kInfo = 20, kWarning = 30 };

// RosLog: the log of the nodes of a process in ROS, /rosout. One writer, which is listed as one of each of them,
// because each node of ROS's own has one, and a hundred robots would add a hundred.
class RosLog {
 public:
  explicit RosLog(const RosNode& node);

  // `node`: "/anna/robot". Any thread may call it, one at a time.
  void Write(LogLevel level, const std::string& node, const std::string& text);

 private:
  RosWriter<rcl_interfaces_msg_dds__Log_> writer_;
};

// The name of a node's logger: "anna.robot" for "/anna/robot".
std::string LoggerName(const std::string& node);

}  // namespace troupe::ros
