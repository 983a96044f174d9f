// GripperAction: a server of the action control_msgs/GripperCommand for one gripper, as rcl lays out actions on topics
// and services. A goal is accepted or refused on arrival and starts at the next tick; feedback and results are sent
// once per tick.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "robot-agent/ros/gripper_goals.h"
#include "ros/connection/ros_participant.h"

namespace troupe {

class GripperAction {
 public:
  // `name`: of the action. REQUIRES: the world outlives the action.
  GripperAction(const ros::RosNode& node, const std::string& name, const WorldDescription& world, GripperId gripper);
  ~GripperAction();

  // As in GripperGoals.
  std::optional<GripperGoals::Order> Begin(Tick tick);
  void AbortAll();

  // Sends feedback, status and results.
  void Publish(const WorldState& state);

  // One line about goals refused since the last call; usually none.
  std::optional<std::string> DrainReport();

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace troupe
