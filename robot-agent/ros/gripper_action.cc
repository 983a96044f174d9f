#include "robot-agent/ros/gripper_action.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

using ros::RosCaller;

// A result or feedback, which have the same fields. The effort is 0: forces are not simulated.
template <typename Message>
Message Describe(const GripperGoal& goal) {
  return {goal.position, 0.0, goal.stalled, goal.reached};
}

constexpr double kTolerance = 1e-9;  // m
// Fingers that stand still for so long without a contact follow another command.
constexpr std::int64_t kPatienceNs = 1'000'000'000;

}  // namespace

// The server starts last: its calls come on other threads, and need all members.
GripperAction::GripperAction(const ros::RosNode& node, const std::string& name, const WorldDescription& world,
                             GripperId gripper)
    : world_(&world),
      gripper_(gripper),
      name_(node.Resolve(name)),
      largest_(ros::LargestOpening(world, gripper)),
      goals_(largest_, ros::MotionOf(world, gripper, PlacedState(world)).opening, world.interval_ns),
      server_(node, name,
              {.send_goal = [this](const RosCaller& caller, const auto& request) { SendGoal(caller, request); },
               .cancel = [this](const RosCaller& caller, const GoalId& id,
                                std::int64_t stamp) { Cancel(caller, id, stamp); },
               .get_result = [this](const RosCaller& caller, const GoalId& id) { GetResult(caller, id); }}) {
  server_.Start();
}

// Goals end as aborted, so that their clients do not wait for ever.
GripperAction::~GripperAction() {
  const std::lock_guard lock(mutex_);
  goals_.AbortAll();
  WriteStatus();
  AnswerCallers();
}

std::optional<GripperGoals::Order> GripperAction::Begin(Tick tick) {
  const std::lock_guard lock(mutex_);
  return goals_.Begin(tick);
}

void GripperAction::AbortAll() {
  const std::lock_guard lock(mutex_);
  goals_.AbortAll();
}

void GripperAction::Publish(const WorldState& state) {
  const std::lock_guard lock(mutex_);
  const GripperGoal* const executing = goals_.executing();
  const GoalId id = executing != nullptr ? executing->id : GoalId{};
  goals_.Observe(state.tick, ros::MotionOf(*world_, gripper_, state));
  if (executing != nullptr && server_.feedback_wanted()) {
    if (const GripperGoal* const goal = goals_.Find(id)) {
      server_.WriteFeedback(id, Describe<control_msgs_action_dds__GripperCommand_Feedback_>(*goal));
    }
  }
  WriteStatus();
  AnswerCallers();
}

std::optional<std::string> GripperAction::DrainReport() {
  const std::lock_guard lock(mutex_);
  const std::uint64_t refused = refusals_.CountToReport();
  if (refused == 0) return std::nullopt;
  return fmt::format("{}: refused a goal of {} m, expected 0 to {:.6g} ({} so far)", name_, refused_, largest_,
                     refused);
}

// Called by the thread of the connection; the order itself is given by the agent's thread, in Begin.
void GripperAction::SendGoal(const RosCaller& caller, const Types::SendGoalRequest& request) {
  const std::lock_guard lock(mutex_);
  const GoalId id = ros::ToGoalId(request.goal_id);
  const bool accepted = goals_.Accept(id, request.goal.command.position, request.goal.command.max_effort);
  if (accepted) {
    WriteStatus();
  } else {
    refused_ = request.goal.command.position;
    refusals_.Count();
  }
  server_.AnswerGoal(caller, accepted, accepted ? goals_.Find(id)->stamp : 0);
}

void GripperAction::Cancel(const RosCaller& caller, const GoalId& id, std::int64_t stamp) {
  const std::lock_guard lock(mutex_);
  const ros::CancelResult<GripperGoal> cancelled = goals_.Cancel(id, stamp);
  WriteStatus();
  server_.AnswerCancel(caller, cancelled);
}

void GripperAction::GetResult(const RosCaller& caller, const GoalId& id) {
  const std::lock_guard lock(mutex_);
  server_.AwaitResult(caller, id);
  AnswerCallers();
}

void GripperAction::AnswerCallers() {
  server_.AnswerResults(goals_.goals(), [](const GripperGoal& goal, dds::WireArena&) {
    return Describe<control_msgs_action_dds__GripperCommand_Result_>(goal);
  });
}

GripperGoals::GripperGoals(double largest_opening, double opening, std::int64_t interval_ns)
    : largest_opening_(largest_opening), interval_ns_(interval_ns), opening_(opening) {}

// Openings outside of the gripper's travel are refused and not clamped: the client would wait for a position that
// cannot be reached.
bool GripperGoals::Accept(const GoalId& id, double opening, double max_effort) {
  const bool possible = std::isfinite(max_effort) && opening >= -kTolerance && opening <= largest_opening_ + kTolerance;
  if (!possible) return false;
  GripperGoal goal;
  goal.id = id;
  goal.stamp = now_ns_;
  goal.opening = std::clamp(opening, 0.0, largest_opening_);
  return goals_.Add(goal);
}

// The newest goal is executed; older ones are aborted. A cancelled goal orders the fingers to stay.
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

// Success is the position, or an object between the fingers on the way to a smaller opening. A motion that ends
// elsewhere is a failure.
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
