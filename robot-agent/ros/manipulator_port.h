// ManipulatorPort: the grippers and joints of one robot in ROS: what they are commanded, and what becomes of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/ros_dds/ros_endpoints.h"
#include "common/spatial/scene.h"
#include "robot-agent/controller/controller.h"
#include "robot-agent/ros/gripper_action.h"
#include "robot-agent/ros/position_input.h"

namespace troupe {

class ManipulatorPort {
 public:
  // The scene must outlive it.
  ManipulatorPort(const ros::RosNode& node, const Scene& scene, RobotId robot);

  // Adds to `command` what came for the tick after `tick`.
  void Take(Tick tick, Command& command);

  void Publish(const WorldState& state);

  // What went wrong since the last call.
  void TakeReports(std::vector<std::string>& reports);

 private:
  struct Gripper {
    GripperId id;
    std::size_t number;               // among the robot's
    std::optional<std::size_t> lift;  // joint of the robot
    double largest_opening;           // m
    std::unique_ptr<PositionInput> opening;
    std::unique_ptr<PositionInput> height;  // may be null
    std::unique_ptr<GripperAction> action;
    std::unique_ptr<ros::RosWriter<ros::String>> state;
  };
  struct Joint {
    std::size_t number;  // among the robot's
    std::unique_ptr<PositionInput> position;
  };

  void TakeGripper(Tick tick, Gripper& gripper, Command& command);

  const WorldDescription* world_;
  std::vector<Gripper> grippers_;
  std::vector<Joint> joints_;  // those of no gripper
};

}  // namespace troupe
