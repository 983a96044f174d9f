#include "robot-agent/ros/gripper_goals.h"

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

constexpr double kTolerance = 1e-9;  // m
// Fingers that stand still for so long without a contact follow another command.
constexpr std::int64_t kPatienceNs = 1'000'000'000;

}  // namespace

GripperGoals::GripperGoals(double largest_opening, double opening, std::int64_t interval_ns)
    : largest_opening_(largest_opening), interval_ns_(interval_ns), opening_(opening) {}

bool GripperGoals::Accept(const GoalId& id, double opening, double max_effort) {
  const bool possible = std::isfinite(max_effort) && opening >= -kTolerance && opening <= largest_opening_ + kTolerance;
  if (!possible) return false;
  GripperGoal goal;
  goal.id = id;
  goal.stamp = now_ns_;
  goal.opening = std::clamp(opening, 0.0, largest_opening_);
  return goals_.Add(goal);
}

std::optional<GripperGoals::Order> GripperGoals::Begin(Tick tick) {
  GripperGoal* newest = nullptr;
  for (auto goal = goals_.all().rbegin(); goal != goals_.all().rend(); ++goal) {
    if (goal->ended()) continue;
    if (newest == nullptr) {
      newest = &*goal;
    } else {
      End(*goal, goal->status == GoalStatus::kCanceling ? GoalStatus::kCanceled : GoalStatus::kAborted, false);
    }
  }
  if (newest == nullptr) return std::nullopt;
  if (newest->status == GoalStatus::kAccepted) {
    newest->status = GoalStatus::kExecuting;
    newest->position = opening_;
    begun_ = tick;
    stay_ordered_ = false;
    still_ns_ = 0;
    return Order{newest->opening};
  }
  if (newest->status == GoalStatus::kExecuting || stay_ordered_) return std::nullopt;
  stay_ordered_ = true;
  begun_ = tick;
  return Order{};
}

void GripperGoals::AbortAll() {
  for (GripperGoal& goal : goals_.all()) {
    if (!goal.ended()) {
      End(goal, goal.status == GoalStatus::kCanceling ? GoalStatus::kCanceled : GoalStatus::kAborted, false);
    }
  }
  stay_ordered_ = false;
  goals_.RemoveOldEnded();
}

void GripperGoals::Observe(Tick tick, const ros::GripperMotion& motion) {
  opening_ = motion.opening;
  now_ns_ = static_cast<std::int64_t>(tick) * interval_ns_;
  goals_.RemoveOldEnded();
  std::vector<GripperGoal>& all = goals_.all();
  const auto active = std::find_if(all.rbegin(), all.rend(), [](const GripperGoal& goal) { return !goal.ended(); });
  // The effect of an order shows one tick later.
  if (active == all.rend() || !begun_ || *begun_ == tick) return;
  GripperGoal& goal = *active;
  if (goal.status == GoalStatus::kCanceling && stay_ordered_) {
    stay_ordered_ = false;
    return End(goal, GoalStatus::kCanceled, false);
  }
  if (goal.status != GoalStatus::kExecuting) return;
  goal.position = opening_;
  still_ns_ = motion.moves ? 0 : still_ns_ + interval_ns_;
  if (std::abs(opening_ - goal.opening) <= kTolerance) {
    goal.reached = true;
    End(goal, GoalStatus::kSucceeded, false);
  } else if (motion.clamped && goal.opening < opening_) {
    End(goal, GoalStatus::kSucceeded, true);
  } else if (!motion.moves && (motion.blocked || still_ns_ >= kPatienceNs)) {
    End(goal, GoalStatus::kAborted, true);
  }
}

void GripperGoals::End(GripperGoal& goal, GoalStatus status, bool stalled) {
  goal.status = status;
  goal.position = opening_;
  goal.stalled = stalled;
}

}  // namespace troupe
