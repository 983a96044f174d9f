// GripperGoals: the goals that the action of one gripper got, and what became of them. It knows nothing of DDS. Goals
// come and are cancelled at any time; what follows from that happens at ticks.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/ids.h"
#include "common/ros/action_goals.h"
#include "common/ros/gripper_state.h"

namespace troupe {

using ros::CancelAnswer;
using ros::GoalId;
using ros::GoalStatus;

// It has succeeded when the opening is reached, or the fingers have closed on an object; it is aborted when something
// else stopped the fingers, or another command came.
struct GripperGoal : ros::ActionGoal {
  double opening = 0.0;  // m, as in common/ros/gripper_state.h
  // Now, or when it ended:
  double position = 0.0;  // m
  bool stalled = false;
  bool reached = false;
};

class GripperGoals {
 public:
  // `opening`: at the start.
  GripperGoals(double largest_opening, double opening, std::int64_t interval_ns);

  // Accepts a goal, or refuses it: not finite, not within 0 and the largest opening, of an id that is known, or one of
  // too many.
  bool Accept(const GoalId& id, double opening, double max_effort);

  // As ActionGoals.
  CancelAnswer Cancel(const GoalId& id, std::int64_t stamp, std::vector<GripperGoal>& canceling) {
    return goals_.Cancel(id, stamp, canceling);
  }

  // What to tell the gripper for the tick after `tick`, when there is something to tell.
  struct Order {
    std::optional<double> opening;  // m; nothing: stay
  };
  std::optional<Order> Begin(Tick tick);

  // Another command came: all goals end.
  void GiveWay();

  // What the gripper did.
  void Observe(Tick tick, const ros::GripperMotion& motion);

  // The goal that moves the gripper, if one does.
  const GripperGoal* executing() const { return goals_.executing(); }
  const GripperGoal* Find(const GoalId& id) const { return goals_.Find(id); }
  const ros::ActionGoals<GripperGoal>& goals() const { return goals_; }

 private:
  void End(GripperGoal& goal, GoalStatus status, bool stalled);

  double largest_opening_;
  std::int64_t interval_ns_;
  double opening_;           // as observed last
  std::int64_t now_ns_ = 0;  // likewise
  ros::ActionGoals<GripperGoal> goals_;
  std::optional<Tick> begun_;  // when the gripper was told of the goal that is executed or cancelled
  bool told_to_stay_ = false;
  std::int64_t still_ns_ = 0;  // for how long the fingers have not moved
};

}  // namespace troupe
