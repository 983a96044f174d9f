// RosLockstepWait: ticks wait for nodes of ROS. docs/ros2-lockstep.md describes what a node sees.
//
// A tick that waits is shown first: the agents publish it while the run is paused for it. Then each ROS domain is told
// with /world/tick, behind all messages of the tick, and the run continues when all named ones have answered: a topic
// by a message, a node by /world/tick_done. A thread of its own passes on what arrives.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/text.h"
#include "common/run/ros_lockstep.h"
#include "common/spatial/scene.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/link/host_connection.h"
#include "ros/messages/ros_options.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class RosLockstepWait {
 public:
  struct Hooks {
    std::function<void(Tick tick, std::int64_t interval_ns)>
        show_clock;                                       // writes /clock of the run's domain; on any thread
    std::function<void(const std::string& line)> report;  // for people; on any thread
  };

  // `of_run`: the connection in the domain of the run, of which nobody else uses WatchTopics. All outlive this.
  RosLockstepWait(ros::HostConnection& of_run, const ros::RosOptions& options, std::shared_ptr<const Scene> scene,
                  RunId run, WorldControl& control, Hooks hooks);
  // After it no call into the control runs.
  ~RosLockstepWait();
  RosLockstepWait(const RosLockstepWait&) = delete;
  RosLockstepWait& operator=(const RosLockstepWait&) = delete;

  bool ShowsTick(Tick tick) const { return tick % period_ == 0; }
  // Calls of an observer.
  void OnWorldChange(std::shared_ptr<const Scene> scene);
  void OnCommit(const FrameMessage& frame);
  void OnShown(const FrameMessage& frame);
  Result<TickRelease> Release();
  bool IsPrepared();
  std::vector<SlowRobot> SlowestAwaited();

 private:
  using Clock = std::chrono::steady_clock;
  struct Channel;

  // What a tick waits for.
  struct Awaited {
    std::string name;  // for people
    bool is_topic = false;
    std::uint32_t watch = 0;  // of a topic
    bool done = false;        // for this tick
    bool was_seen = false;    // it has answered once
    bool is_dropped = false;  // no tick waits for it until it is heard of again
    std::uint64_t times_last = 0;
    double waited_seconds = 0.0;
  };

  void Run();
  // REQUIRES of those below: mutex_ is held.
  void Follow(const Scene& scene);
  void Arm(const std::string& text);
  std::string TextOf(Edition edition, Tick tick) const;
  // Continues what the channels have answered. True: the run is to ask again.
  bool Advance();
  void Announce(Channel& channel, const std::string& topics);
  void ReadAnswers(Channel& channel);
  void Note(Awaited& awaited);
  Status DropAtLimit(Awaited& awaited, double waited);

  ros::HostConnection& of_run_;
  const ros::RosOptions options_;
  const RunId run_;
  const std::uint64_t period_;
  const double limit_;  // s; 0: none
  const bool ends_at_limit_;
  WorldControl& control_;
  const Hooks hooks_;
  FloodLimiter reports_;

  std::mutex signal_mutex_;  // guards the two below; held for no call
  std::condition_variable signal_;
  bool is_signalled_ = true;
  bool stop_ = false;

  std::mutex mutex_;  // guards all below
  std::shared_ptr<const Scene> scene_;
  bool follow_ = true;  // the world is new
  std::vector<std::unique_ptr<Channel>> channels_;
  std::string armed_;  // the newest text
  Clock::time_point armed_at_ = {};
  bool is_shown_ = false;  // a tick waits
  Edition edition_ = 0;    // of that
  Tick tick_ = 0;
  std::int64_t interval_ns_ = 0;
  Clock::time_point shown_at_ = {};
  bool told_first_ = false;  // that the first answers are awaited
  std::thread thread_;       // last, because it uses all other members
};

}  // namespace troupe
