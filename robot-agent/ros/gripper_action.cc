#include "robot-agent/ros/gripper_action.h"

#include <fmt/format.h>

namespace troupe {
namespace {

using ros::RosCaller;

// A result or feedback, which have the same fields. The effort is 0: forces are not simulated.
template <typename Message>
Message Describe(const GripperGoal& goal) {
  return {goal.position, 0.0, goal.stalled, goal.reached};
}

}  // namespace

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

}  // namespace troupe
