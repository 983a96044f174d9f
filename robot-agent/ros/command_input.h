// CommandInput: the motion commands of one robot from ROS, each valid for a timeout.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/ros/refusals.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/messages/ros_options.h"
#include "troupe/controller.h"

namespace troupe {

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
  // Of one type: a reliable reader, by which a command that is sent once arrives, and one for best-effort writers.
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

}  // namespace troupe
