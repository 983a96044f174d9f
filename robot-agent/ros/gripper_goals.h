// GripperGoals: the goals that the action of one gripper got, and what became of them. It knows nothing of DDS. Goals
// come and are cancelled at any time; what follows from that happens at ticks.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/ids.h"
#include "common/ros/gripper_state.h"

namespace troupe {

// With the numbers of action_msgs.
enum class GoalStatus : std::int8_t {
  kUnknown = 0,
  kAccepted = 1,
  kExecuting = 2,
  kCanceling = 3,
  kSucceeded = 4,  // the opening is reached, or the fingers have closed on an object
  kCanceled = 5,
  kAborted = 6,  // something else stopped the fingers, or another command came
};
enum class CancelAnswer : std::int8_t { kNone = 0, kRejected = 1, kUnknownGoal = 2, kGoalHasEnded = 3 };

using GoalId = std::array<std::uint8_t, 16>;

struct GripperGoal {
  GoalId id = {};
  std::int64_t stamp = 0;  // ns, simulated time when it was accepted
  double opening = 0.0;    // m, as in common/ros/gripper_state.h
  GoalStatus status = GoalStatus::kAccepted;
  // Now, or when it ended:
  double position = 0.0;  // m
  bool stalled = false;
  bool reached = false;

  bool ended() const { return status >= GoalStatus::kSucceeded; }
};

class GripperGoals {
 public:
  // `opening`: at the start.
  GripperGoals(double largest_opening, double opening, std::int64_t interval_ns);

  // Accepts a goal, or refuses it: not finite, not within 0 and the largest opening, of an id that is known, or one of
  // too many.
  bool Accept(const GoalId& id, double opening, double max_effort);

  // As action_msgs/CancelGoal: the goal of this id, and all that came at `stamp` (ns) or before. An id of zeros is
  // none, and a stamp of 0 too; without both, all. `canceling`: those that will end by this.
  CancelAnswer Cancel(const GoalId& id, std::int64_t stamp, std::vector<GripperGoal>& canceling);

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
  const GripperGoal* executing() const;
  const GripperGoal* Find(const GoalId& id) const;
  // Those that have not ended and some that have, in the order in which they came.
  const std::vector<GripperGoal>& goals() const { return goals_; }

 private:
  void End(GripperGoal& goal, GoalStatus status, bool stalled);
  void Forget();

  double largest_opening_;
  std::int64_t interval_ns_;
  double opening_;           // as observed last
  std::int64_t now_ns_ = 0;  // likewise
  std::vector<GripperGoal> goals_;
  std::optional<Tick> begun_;  // when the gripper was told of the goal that is executed or cancelled
  bool told_to_stay_ = false;
  std::int64_t still_ns_ = 0;  // for how long the fingers have not moved
};

}  // namespace troupe
