// GripperAction: a server of the action control_msgs/GripperCommand for one gripper, as rcl lays out actions on topics
// and services. A goal is accepted or refused on arrival and starts at the next tick; feedback and results are sent
// once per tick.
// Requests arrive on threads of the connection and only note the goal under a mutex; the agent's thread starts, watches
// and ends goals between ticks. So requests between the same two ticks have the same effect, at whatever moment they
// arrived.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "robot-agent/ros/command_input.h"
#include "ros/connection/action_server.h"
#include "ros/messages/action_goals.h"
#include "ros/messages/text_messages.h"
#include "troupe/ids.h"

namespace troupe {

using ros::CancelAnswer;
using ros::GoalId;
using ros::GoalStatus;

// A goal succeeds when the fingers reach the opening or close on an object. It is aborted when something else stops the
// fingers or another command replaces it.
struct GripperGoal : ros::ActionGoal {
  double opening = 0.0;  // m, as in ros/messages/text_messages.h
  // Now, or at its end:
  double position = 0.0;  // m
  bool stalled = false;
  bool reached = false;
};

// GripperGoals: the goals of the action of one gripper and their states, without any DDS. Goals arrive and are
// cancelled at any time; their effects happen at ticks.
class GripperGoals {
 public:
  // `opening`: at the start.
  GripperGoals(double largest_opening, double opening, std::int64_t interval_ns);

  // False, and no effect, on a number that is not finite, an opening (m) outside [0, largest opening], an id in use, or
  // too many open goals.
  bool Accept(const GoalId& id, double opening, double max_effort);

  // As ActionGoals.
  ros::CancelResult<GripperGoal> Cancel(const GoalId& id, std::int64_t stamp) { return goals_.Cancel(id, stamp); }

  // A command to the gripper.
  struct Order {
    std::optional<double> opening;  // m; none: stay
  };
  // The command for the tick after `tick`, if a goal starts or a cancelled one stops.
  std::optional<Order> Begin(Tick tick);

  // Ends all goals, because another command replaces them.
  void AbortAll();

  // Updates the goals from the gripper's motion in the tick that led to `tick`.
  void Observe(Tick tick, const ros::GripperMotion& motion);

  // The goal that moves the gripper; null if none does.
  const GripperGoal* executing() const { return goals_.executing(); }
  const GripperGoal* Find(const GoalId& id) const { return goals_.Find(id); }
  const ros::ActionGoals<GripperGoal>& goals() const { return goals_; }

 private:
  void End(GripperGoal& goal, GoalStatus status, bool stalled);

  double largest_opening_;
  std::int64_t interval_ns_;
  double opening_;           // as last observed
  std::int64_t now_ns_ = 0;  // simulated time of the last observation
  ros::ActionGoals<GripperGoal> goals_;
  std::optional<Tick> begun_;  // the tick of the last order
  bool stay_ordered_ = false;
  std::int64_t still_ns_ = 0;  // time since the fingers last moved
};

class GripperAction {
 public:
  // `name`: of the action. REQUIRES: the world outlives the action.
  GripperAction(const ros::RosNode& node, const std::string& name, const WorldDescription& world, GripperId gripper);
  // Aborts the goals that have not ended, as at a reset: their clients would wait in vain.
  ~GripperAction();
  GripperAction(const GripperAction&) = delete;
  GripperAction& operator=(const GripperAction&) = delete;

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
