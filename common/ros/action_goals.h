// ActionGoals<Goal>: the goals that the server of an action got, as rcl keeps them. It knows nothing of DDS.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace troupe::ros {

// With the numbers of action_msgs.
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

// What a Goal derives from.
struct ActionGoal {
  GoalId id = {};
  std::int64_t stamp = 0;  // ns, simulated time when it was accepted
  GoalStatus status = GoalStatus::kAccepted;

  bool ended() const { return status >= GoalStatus::kSucceeded; }
};

template <typename Goal>
class ActionGoals {
 public:
  // Refuses one whose id is known, or one of too many.
  bool Add(const Goal& goal) {
    const auto open = std::count_if(goals_.begin(), goals_.end(), [](const Goal& other) { return !other.ended(); });
    if (Find(goal.id) != nullptr || static_cast<std::size_t>(open) >= kMostOpen) return false;
    goals_.push_back(goal);
    return true;
  }

  // As action_msgs/CancelGoal: the goal of this id, and all that came at `stamp` (ns) or before. An id of zeros is
  // none, and a stamp of 0 too; without both, all. `canceling`: those that will end by this.
  CancelAnswer Cancel(const GoalId& id, std::int64_t stamp, std::vector<Goal>& canceling) {
    const bool by_id = id != GoalId{};
    CancelAnswer answer = by_id && stamp == 0 ? CancelAnswer::kUnknownGoal : CancelAnswer::kNone;
    for (Goal& goal : goals_) {
      const bool is_meant = (by_id && goal.id == id) || (stamp != 0 && goal.stamp <= stamp) || (!by_id && stamp == 0);
      if (!is_meant) continue;
      if (goal.status == GoalStatus::kAccepted || goal.status == GoalStatus::kExecuting) {
        goal.status = GoalStatus::kCanceling;
        canceling.push_back(goal);
        answer = CancelAnswer::kNone;
      } else if (answer == CancelAnswer::kUnknownGoal) {
        answer = CancelAnswer::kGoalHasEnded;
      }
    }
    return answer;
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

  // Those that have not ended and some that have, in the order in which they came.
  std::vector<Goal>& all() { return goals_; }
  const std::vector<Goal>& all() const { return goals_; }

  // Keeps the latest few of those that have ended.
  void Forget() {
    auto ended = std::count_if(goals_.begin(), goals_.end(), [](const Goal& goal) { return goal.ended(); });
    std::erase_if(goals_,
                  [&](const Goal& goal) { return goal.ended() && ended-- > static_cast<std::ptrdiff_t>(kMostEnded); });
  }

 private:
  static constexpr std::size_t kMostOpen = 100;
  static constexpr std::size_t kMostEnded = 16;

  template <typename Condition>
  Goal* FindIf(const Condition& condition) {
    const auto found = std::find_if(goals_.begin(), goals_.end(), condition);
    return found == goals_.end() ? nullptr : &*found;
  }

  std::vector<Goal> goals_;
};

}  // namespace troupe::ros
