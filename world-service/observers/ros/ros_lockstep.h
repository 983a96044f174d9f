// RosLockstepWait: ticks wait for nodes of ROS. docs/ros2-lockstep.md describes what a node sees.
//
// The agents publish a tick that waits while the run is paused for it. Then each ROS domain is told with /world/tick,
// behind all messages of the tick, and the run continues when all named ones have answered: a topic by a message, a
// node by /world/tick_done. The threads of the connections note the answers.
//
// Two races decide the design. A fast node may answer a message of the tick before this process knows that the tick is
// published: so the host's program is armed with the name of the tick before the agents see the frame (OnCommit), and
// notes arrivals from then on. And a message may be under way while the tick is announced: so the announcement travels
// through the same program, behind the messages of all agents, and is `told` only when readers have it. That program
// holds back the first tick of a participant until the participant can receive it: so it is to know of all participants
// before agents show a tick (OnBegin, OnWorldChange).
//
// The wait changes when a tick is made and never its result; a node's commands are journalled like any others. Limits
// are in wall time and end or continue the run, as the options say.
//
// The states of a wait and of each participant are in TickAnswers; this file has the connections that feed it. A
// channel is the connection in one ROS domain; it is told of a tick once the program has written the announcement.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/base/text.h"
#include "common/run/ros_lockstep.h"
#include "common/spatial/scene.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/link/host_connection.h"
#include "ros/messages/ros_options.h"
#include "world-service/observers/ros/tick_answers.h"
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
  // with `on_arrival` for others. All outlive this. `has_released`: a service before has released a tick of the run.
  RosLockstepWait(ros::HostConnection& of_run, const ros::RosOptions& options, std::shared_ptr<const Scene> scene,
                  RunId run, bool has_released, WorldControl& control, Hooks hooks);
  // After it no call into the control runs.
  ~RosLockstepWait();
  RosLockstepWait(const RosLockstepWait&) = delete;
  RosLockstepWait& operator=(const RosLockstepWait&) = delete;

  bool ShowsTick(Tick tick) const { return tick % period_ == 0; }
  // Waits until the program of the host knows the participants, for some seconds at most.
  void AwaitPrepared();
  // Calls of an observer.
  void OnWorldChange(std::shared_ptr<const Scene> scene);
  void OnCommit(const FrameMessage& frame);
  void OnShown(const FrameMessage& frame);
  Result<TickRelease> Release();
  bool IsPrepared();
  std::vector<SlowRobot> SlowestAwaited();

 private:
  struct Channel;

  // Ends the channels that nothing uses any more, without the mutex and without the lock of the run: their threads may
  // wait for either.
  void EndUnused();
  // On the thread of a connection: something has arrived.
  void OnArrival();
  // REQUIRES of those below: mutex_ is held.
  // Makes the channels of the scene's participants.
  void Follow(const Scene& scene);
  void WatchParticipants(Channel& channel, const std::set<TickAnswers::Name>& names);
  std::set<TickAnswers::Name> ParticipantsIn(const Scene& scene) const;
  // The channel of the domain, one of `before` if it had one.
  Channel& OpenChannel(std::uint32_t domain, std::vector<std::unique_ptr<Channel>>& before);
  void Arm(const std::string& text);
  std::string TextOf(Edition edition, Tick tick) const;
  static std::string_view TickIn(std::string_view text);
  bool IsArmed() const;
  // Notes what has arrived. True: the run is to ask again.
  bool Advance();
  void Announce(Channel& channel);
  std::set<std::uint32_t> AwaitedOf(const Channel& channel) const;
  void NoteDelivery();
  void NoteCalls();
  // By which the announcement of the tick begins.
  std::string EditionEntry() const;
  void ReadAnswers(Channel& channel);

  ros::HostConnection& of_run_;
  const ros::RosOptions options_;
  const RunId run_;
  const std::uint64_t period_;
  WorldControl& control_;
  const Hooks hooks_;
  FloodLimiter reports_;

  std::mutex mutex_;                 // guards all below
  std::condition_variable changed_;  // stop_ or unused_
  std::condition_variable arrived_;  // something, on the thread of a connection
  bool stop_ = false;
  std::shared_ptr<const Scene> scene_;
  std::vector<std::unique_ptr<Channel>> channels_;
  std::vector<std::unique_ptr<Channel>> unused_;
  TickAnswers answers_;
  std::string armed_;         // the newest text
  std::string armed_before_;  // the one before
  double armed_at_ = 0.0;
  std::uint64_t drops_ = 0;  // that channels know of
  Edition edition_ = 0;      // of the tick that was published last
  std::int64_t interval_ns_ = 0;
  std::thread thread_;  // last, because it uses all other members
};

}  // namespace troupe
