// GripperGoals: the goals of the action of one gripper and their states, without any DDS. Goals arrive and are
// cancelled at any time; their effects happen at ticks.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ros/messages/action_goals.h"
#include "ros/messages/gripper_state.h"
#include "troupe/ids.h"

namespace troupe {

using ros::CancelAnswer;
using ros::GoalId;
using ros::GoalStatus;

// A goal succeeds when the fingers reach the opening or close on an object. It is aborted when something else stops the
// fingers or another command replaces it.
struct GripperGoal : ros::ActionGoal {
  double opening = 0.0;  // m, as in ros/messages/gripper_state.h
  // Now, or at its end:
  double position = 0.0;  // m
  bool stalled = false;
  bool reached = false;
};

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

}  // namespace troupe
