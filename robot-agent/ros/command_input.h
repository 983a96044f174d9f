// The input of one robot from ROS: commands of motion (cmd_vel), messages to send by radio, and reports of refusals.
//
// Commands are applied at a tick and not when they arrive: between two ticks the newest counts. A command lasts for a
// time of the simulation (command_timeout), so that a run at ten times real time stops its robots after the same
// distance as one at real time. Numbers that are not finite are refused and counted.
//
// A reader of DDS is reliable or best-effort, and a best-effort writer does not match a reliable reader: a second
// reader is opened as soon as such a writer is discovered, and not before, since every tool discovers every endpoint.
//
// All functions are called by the agent's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "robot-agent/agent/gateway.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/ros_options.h"
#include "troupe/controller.h"

namespace troupe {

// Refusals: counts the refused commands of one input, and reports the count at 1, 10, 100, ..., so that a peer that
// sends a thousand a second does not fill the log.
class Refusals {
 public:
  void Count() { ++count_; }

  // The count so far if a report is due, else 0.
  std::uint64_t CountToReport() {
    if (count_ == 0 || (reported_ > 0 && count_ < 10 * reported_)) return 0;
    reported_ = count_;
    return count_;
  }

 private:
  std::uint64_t count_ = 0;
  std::uint64_t reported_ = 0;
};

// CommandInput: the motion commands of one robot from ROS, each valid for a timeout.
class CommandInput {
 public:
  // REQUIRES: the robot's description outlives the input.
  CommandInput(const ros::RosNode& node, const ros::RobotTopics& topics, const RobotDescription& robot,
               double interval_seconds);

  // The newest command, unless its timeout has passed. The timeout counts simulated time, so that a run behaves the
  // same at any speed.
  std::optional<Command> CommandAt(Tick tick);

  // Time restarts: drops all commands received before.
  void Restart();

  // One line about commands refused since the last call; usually none.
  std::optional<std::string> DrainReport();

 private:
  // The readers of one type: a reliable one, by which a command that is sent once arrives, and one for best-effort
  // writers.
  template <typename T>
  class Readers {
   public:
    void Open(const ros::RosNode& node, bool reliable_only);
    template <typename Consume>
    void Drain(const Consume& consume) {
      if (reliable_) reliable_->Drain(consume);
      if (best_effort_) best_effort_->Drain(consume);
    }
    // Opens the second reader if it is needed now.
    void OpenMissing();

   private:
    ros::RosNode node_;
    std::unique_ptr<ros::RosReader<T>> reliable_;
    std::unique_ptr<ros::RosReader<T>> best_effort_;
  };

  void Apply(const ros::TwistMessage& twist, Tick tick);

  const RobotDescription* robot_;
  double timeout_ticks_;  // 0: commands never expire
  Readers<ros::TwistMessage> twists_;
  Readers<ros::TwistStamped> stamped_twists_;
  std::optional<Command> command_;
  Tick received_ = 0;
  Refusals refusals_;
};

// RadioPort: the radios of one robot in ROS: "<radio>/send" takes messages, "<radio>/received" has those that arrive.
class RadioPort {
 public:
  // REQUIRES: the scene outlives the port, or the next call of ChangeWorld.
  RadioPort(const ros::RosNode& node, const Scene& scene, RobotId robot);

  // Appends the messages received from ROS since the last call to those that the robot is to send.
  void AddMessages(std::vector<RadioMessage>& messages);

  // The messages that arrive at this tick. Once for each tick.
  void Publish(const RobotView& robot);

  // Another world that has the same robot.
  void ChangeWorld(const Scene& scene) { world_ = &scene.world(); }
  // Drops the messages that came before.
  void Restart();

  // A line for each radio that refused messages since the last call.
  std::vector<std::string> DrainReports();

 private:
  struct Radio {
    std::size_t sensor;      // in RobotDescription::sensors
    std::string topic;       // of messages to be sent
    std::size_t most_bytes;  // of a message
    std::unique_ptr<ros::RosReader<ros::String>> input;
    std::unique_ptr<ros::RosWriter<ros::String>> output;
    Refusals refusals = {};
    std::string reason = {};  // of the newest refusal
  };

  const WorldDescription* world_;
  std::vector<Radio> radios_;
};

}  // namespace troupe
