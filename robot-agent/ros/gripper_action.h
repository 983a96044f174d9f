// GripperAction: a server of the action control_msgs/GripperCommand for one gripper, as rcl lays out actions on topics
// and services. Goals are accepted or refused at once; they begin at the next tick, and what came of them is told at
// ticks.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/ros_dds/ros_participant.h"
#include "robot-agent/ros/gripper_goals.h"

namespace troupe {

class GripperAction {
 public:
  // The world must outlive it. `name`: of the action.
  GripperAction(const ros::RosNode& node, const std::string& name, const WorldDescription& world, GripperId gripper);
  ~GripperAction();

  // As in GripperGoals.
  std::optional<GripperGoals::Order> Begin(Tick tick);
  void GiveWay();

  // Tells feedback, status and results.
  void Publish(const WorldState& state);

  // What went wrong since the last call, in one line; usually "".
  std::string TakeReport();

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace troupe
