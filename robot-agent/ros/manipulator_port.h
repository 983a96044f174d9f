// ManipulatorPort: the commands and states of the grippers and joints of one robot in ROS. A gripper has an action
// (GripperAction), a topic for its opening, one for its height, and a topic of texts with its state; each other joint
// has a topic for its position. Positions are clamped to the range of the joint (m or rad). The commands are joined
// with the motion in one Command of the tick, whatever the source of the motion.
//
// Called by the agent's thread; only the action's requests come from other threads.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "robot-agent/ros/command_input.h"
#include "robot-agent/ros/gripper_action.h"
#include "ros/connection/ros_endpoints.h"
#include "troupe/controller.h"
#include "troupe/world_description.h"

namespace troupe {

// PositionInput: commanded positions on a topic of std_msgs/Float64.
class PositionInput {
 public:
  // The reader is reliable, because such a command is often sent only once.
  PositionInput(const ros::RosNode& node, const std::string& topic, const Interval& range);

  // The newest position received since the last call, clamped to the range.
  std::optional<double> Latest();

  // One line about commands refused since the last call; usually none.
  std::optional<std::string> DrainReport();

 private:
  std::string topic_;
  Interval range_;
  ros::RosReader<ros::Float64> reader_;
  Refusals refusals_;
};

class ManipulatorPort {
 public:
  // REQUIRES: the scene outlives the port.
  ManipulatorPort(const ros::RosNode& node, const Scene& scene, RobotId robot);

  // The motion `command` with the commands to grippers and joints for the tick after `tick`.
  Command WithCommands(Tick tick, Command command);

  // The progress of the actions. Once for each tick.
  void PublishActions(const WorldState& state);
  void PublishStates(const WorldState& state);

  // A line for each input that refused commands since the last call.
  std::vector<std::string> DrainReports();

 private:
  struct Gripper {
    GripperId id;
    std::size_t number;               // index in the robot
    std::optional<std::size_t> lift;  // index among the joints of the robot
    double largest_opening;           // m
    std::unique_ptr<PositionInput> opening;
    std::unique_ptr<PositionInput> height;  // may be null
    std::unique_ptr<GripperAction> action;
    std::unique_ptr<ros::RosWriter<ros::String>> state;
  };
  struct Joint {
    std::size_t number;  // index in the robot
    std::unique_ptr<PositionInput> position;
  };

  void AppendGripperCommands(Tick tick, Gripper& gripper, Command& command);

  const WorldDescription* world_;
  std::vector<Gripper> grippers_;
  std::vector<Joint> joints_;  // all that belong to no gripper
};

}  // namespace troupe
