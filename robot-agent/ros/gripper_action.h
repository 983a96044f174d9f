// GripperAction: a server of the action control_msgs/GripperCommand for one gripper, as rcl lays out actions on topics
// and services. A goal is accepted or refused on arrival and starts at the next tick; feedback and results are sent
// once per tick.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "robot-agent/ros/gripper_goals.h"
#include "robot-agent/ros/refusals.h"
#include "ros/connection/action_server.h"

namespace troupe {

class GripperAction {
 public:
  // `name`: of the action. REQUIRES: the world outlives the action.
  GripperAction(const ros::RosNode& node, const std::string& name, const WorldDescription& world, GripperId gripper);

  // As in GripperGoals.
  std::optional<GripperGoals::Order> Begin(Tick tick);
  void AbortAll();

  // Sends feedback, status and results.
  void Publish(const WorldState& state);

  // One line about goals refused since the last call; usually none.
  std::optional<std::string> DrainReport();

 private:
  TROUPE_ACTION_TYPES(Types, control_msgs_action_dds__GripperCommand);

  void SendGoal(const ros::RosCaller& caller, const Types::SendGoalRequest& request);
  void Cancel(const ros::RosCaller& caller, const GoalId& id, std::int64_t stamp);
  void GetResult(const ros::RosCaller& caller, const GoalId& id);
  void AnswerCallers();
  void WriteStatus() { server_.WriteStatus(goals_.goals().all()); }

  const WorldDescription* world_;
  GripperId gripper_;
  std::string name_;
  double largest_;
  std::mutex mutex_;  // guards the members below
  GripperGoals goals_;
  Refusals refusals_;
  double refused_ = 0.0;             // m, of the last refused goal
  ros::ActionServer<Types> server_;  // last, because it calls members above
};

}  // namespace troupe
