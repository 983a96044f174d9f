// ActionGoals<Goal>: the goals of an action server and their states, as rcl keeps them, without any DDS.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace troupe::ros {

// The numbers of action_msgs.
enum class GoalStatus : std::int8_t {
  kUnknown = 0,
  kAccepted = 1,
  kExecuting = 2,
  kCanceling = 3,
  kSucceeded = 4,
  kCanceled = 5,
  kAborted = 6,
};
enum class CancelAnswer : std::int8_t { kNone = 0, kRejected = 1, kUnknownGoal = 2, kGoalHasEnded = 3 };

using GoalId = std::array<std::uint8_t, 16>;

// The base of every type of goal.
struct ActionGoal {
  GoalId id = {};
  std::int64_t stamp = 0;  // ns, simulated time of acceptance
  GoalStatus status = GoalStatus::kAccepted;

  bool ended() const { return status >= GoalStatus::kSucceeded; }
};

template <typename Goal>
struct CancelResult {
  CancelAnswer answer = CancelAnswer::kNone;
  std::vector<Goal> canceling;  // the goals that now end
};

template <typename Goal>
class ActionGoals {
 public:
  // False, and no effect, if the id is known or kMaxOpen goals are open.
  bool Add(const Goal& goal) {
    const auto open = std::count_if(goals_.begin(), goals_.end(), [](const Goal& other) { return !other.ended(); });
    if (Find(goal.id) != nullptr || static_cast<std::size_t>(open) >= kMaxOpen) return false;
    goals_.push_back(goal);
    return true;
  }

  // As action_msgs/CancelGoal: cancels the goal of this id and all goals accepted at `stamp` (ns) or before. An id of
  // zeros names no goal, a stamp of 0 no time; without both, all goals are meant.
  CancelResult<Goal> Cancel(const GoalId& id, std::int64_t stamp) {
    const bool by_id = id != GoalId{};
    CancelResult<Goal> result;
    if (by_id && stamp == 0) result.answer = CancelAnswer::kUnknownGoal;
    for (Goal& goal : goals_) {
      const bool is_meant = (by_id && goal.id == id) || (stamp != 0 && goal.stamp <= stamp) || (!by_id && stamp == 0);
      if (!is_meant) continue;
      if (goal.status == GoalStatus::kAccepted || goal.status == GoalStatus::kExecuting) {
        goal.status = GoalStatus::kCanceling;
        result.canceling.push_back(goal);
        result.answer = CancelAnswer::kNone;
      } else if (result.answer == CancelAnswer::kUnknownGoal) {
        result.answer = CancelAnswer::kGoalHasEnded;
      }
    }
    return result;
  }

  // Null if there is none.
  Goal* Find(const GoalId& id) {
    return FindIf([&](const Goal& goal) { return goal.id == id; });
  }
  const Goal* Find(const GoalId& id) const { return const_cast<ActionGoals*>(this)->Find(id); }
  Goal* executing() {
    return FindIf([](const Goal& goal) { return goal.status == GoalStatus::kExecuting; });
  }
  const Goal* executing() const { return const_cast<ActionGoals*>(this)->executing(); }

  // The open goals and the latest ended ones, in order of arrival.
  std::vector<Goal>& all() { return goals_; }
  const std::vector<Goal>& all() const { return goals_; }

  // Removes ended goals, except for the latest kMaxEnded.
  void RemoveOldEnded() {
    auto ended = std::count_if(goals_.begin(), goals_.end(), [](const Goal& goal) { return goal.ended(); });
    std::erase_if(goals_,
                  [&](const Goal& goal) { return goal.ended() && ended-- > static_cast<std::ptrdiff_t>(kMaxEnded); });
  }

 private:
  static constexpr std::size_t kMaxOpen = 100;
  static constexpr std::size_t kMaxEnded = 16;

  template <typename Condition>
  Goal* FindIf(const Condition& condition) {
    const auto found = std::find_if(goals_.begin(), goals_.end(), condition);
    return found == goals_.end() ? nullptr : &*found;
  }

  std::vector<Goal> goals_;
};

}  // namespace troupe::ros
