// CommandInput: the commands of one robot from ROS, and how long each counts.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/ros/ros_options.h"
#include "common/ros_dds/ros_endpoints.h"
#include "robot-agent/controller/controller.h"
#include "robot-agent/ros/refusals.h"

namespace troupe {

class CommandInput {
 public:
  // The robot's description must outlive it.
  CommandInput(const ros::RosNode& node, const ros::RosOptions& options, const RobotDescription& robot,
               double interval_seconds);

  // The newest command, if one came within the command timeout. Simulated time alone decides, so that a run at any
  // speed behaves the same.
  std::optional<Command> At(Tick tick);

  // Time begins anew: no command that came before counts.
  void Restart();

  // What went wrong since the last call, in one line; usually "".
  std::string TakeReport();

 private:
  void Take(const ros::TwistMessage& twist, Tick tick);

  const RobotDescription* robot_;
  double timeout_ticks_;                                               // 0: none
  std::unique_ptr<ros::RosReader<ros::TwistMessage>> twists_;          // may be null
  std::unique_ptr<ros::RosReader<ros::TwistStamped>> stamped_twists_;  // may be null
  std::optional<Command> command_;
  Tick received_ = 0;
  Refusals refusals_;
};

}  // namespace troupe
