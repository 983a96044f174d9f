// RosLockstepWait: ticks wait for nodes of ROS. docs/ros2-lockstep.md describes what a node sees.
//
// The agents publish a tick that waits while the run is paused for it. Then each ROS domain is told with /world/tick,
// behind all messages of the tick, and the run continues when all named ones have answered: a topic by a message, a
// node by /world/tick_done. The threads of the connections note the answers; a thread of its own makes and ends
// connections when the world has changed, because no tick may wait for that.
//
// Two races decide the design. A fast node may answer a message of the tick before this process knows that the tick is
// published: so the host's program is armed with the name of the tick before the agents see the frame (OnCommit), and
// notes arrivals from then on. And a message may be under way while the tick is announced: so the announcement travels
// through the same program, behind the messages of all agents, and is `told` only when readers have it.
//
// The wait changes when a tick is made and never its result; a node's commands are journalled like any others. Limits
// are in wall time and end or continue the run, as the options say.
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
        show_clock;                                       // writes /clock of the run's domain; one call at a time
    std::function<void(const std::string& line)> report;  // for users; on any thread
    std::function<void()> on_arrival;                     // of the run's domain; on the thread of its connection
  };

  // `of_run`: the connection in the domain of the run; while this exists, it has the connection's WatchTopics,
  // with `on_arrival` for others. All outlive this.
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
    std::string name;  // for users
    bool is_topic = false;
    std::uint32_t watch = 0;  // of a topic
    bool done = false;        // for this tick
    bool was_seen = false;    // it has answered once
    bool is_dropped = false;  // no tick waits for it until it is heard of again
    std::uint64_t times_last = 0;
    double waited_seconds = 0.0;
  };

  void Run();
  // On the thread of a connection: something has arrived.
  void OnArrival();
  // REQUIRES of those below: mutex_ is held.
  // Returns the channels that nothing uses any more. They end without the mutex: their threads may wait for it.
  std::vector<std::unique_ptr<Channel>> Follow(const Scene& scene);
  void Arm(const std::string& text);
  std::string TextOf(Edition edition, Tick tick) const;
  bool IsArmed() const;
  // Notes what has arrived. True: the run is to ask again.
  bool Advance();
  void Announce(Channel& channel);
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

  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  bool stop_ = false;
  std::shared_ptr<const Scene> scene_;
  bool follow_ = true;  // the world is new
  std::vector<std::unique_ptr<Channel>> channels_;
  std::string armed_;  // the newest text
  Clock::time_point armed_at_ = {};
  bool awaits_armed_ = false;    // the run asks again when the channels know the text
  bool awaits_answers_ = false;  // the agents have published a tick, and the run waits for its release
  Edition edition_ = 0;          // of that
  Tick tick_ = 0;
  std::int64_t interval_ns_ = 0;
  Clock::time_point published_at_ = {};
  bool first_wait_is_over_ = false;  // the first answers have come, or a notice says that they are awaited
  std::thread thread_;               // last, because it uses all other members
};

}  // namespace troupe
