#include "robot-agent/ros/gripper_action.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "common/ros_dds/ros_endpoints.h"
#include "common/ros_dds/ros_service.h"
#include "robot-agent/ros/refusals.h"

namespace troupe {
namespace {

using ros::RosCaller;
using SendGoalRequest = control_msgs_action_dds__GripperCommand_SendGoal_Request_;
using SendGoalResponse = control_msgs_action_dds__GripperCommand_SendGoal_Response_;
using GetResultRequest = control_msgs_action_dds__GripperCommand_GetResult_Request_;
using GetResultResponse = control_msgs_action_dds__GripperCommand_GetResult_Response_;
using CancelRequest = action_msgs_srv_dds__CancelGoal_Request_;
using CancelResponse = action_msgs_srv_dds__CancelGoal_Response_;
using FeedbackMessage = control_msgs_action_dds__GripperCommand_FeedbackMessage_;
using StatusMessage = action_msgs_msg_dds__GoalStatusArray_;
using Uuid = unique_identifier_msgs_msg_dds__UUID_;

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::int32_t kFeedbackDepth = 10;
constexpr std::size_t kMostCallers = 100;

GoalId ToGoalId(const Uuid& uuid) {
  GoalId id;
  std::copy(std::begin(uuid.uuid), std::end(uuid.uuid), id.begin());
  return id;
}

Uuid ToUuid(const GoalId& id) {
  Uuid uuid{};
  std::copy(id.begin(), id.end(), std::begin(uuid.uuid));
  return uuid;
}

ros::Time ToTime(std::int64_t ns) {
  return {static_cast<std::int32_t>(ns / kNanosecondsPerSecond),
          static_cast<std::uint32_t>(ns % kNanosecondsPerSecond)};
}

action_msgs_msg_dds__GoalInfo_ InfoOf(const GripperGoal& goal) {
  return {ToUuid(goal.id), ToTime(goal.stamp)};
}

// Of a result or of feedback, which are alike. Forces are not simulated.
template <typename Message>
Message Describe(const GripperGoal& goal) {
  return {goal.position, 0.0, goal.stalled, goal.reached};
}

}  // namespace

class GripperAction::Server {
 public:
  Server(const ros::RosNode& node, const std::string& name, const WorldDescription& world, GripperId gripper)
      : world_(&world),
        gripper_(gripper),
        name_(node.Resolve(name)),
        largest_(ros::LargestOpening(world, gripper)),
        goals_(largest_, ros::MotionOf(world, gripper, InitialState(world)).opening, world.interval_ns),
        feedback_(node, name + "/_action/feedback", ros::Stream(kFeedbackDepth)),
        status_(node, name + "/_action/status", ros::Latched()),
        send_goal_(node, name + "/_action/send_goal",
                   [this](const RosCaller& caller, const SendGoalRequest& request) { SendGoal(caller, request); }),
        cancel_(node, name + "/_action/cancel_goal",
                [this](const RosCaller& caller, const CancelRequest& request) { Cancel(caller, request); }),
        get_result_(node, name + "/_action/get_result",
                    [this](const RosCaller& caller, const GetResultRequest& request) { GetResult(caller, request); }) {}

  std::optional<GripperGoals::Order> Begin(Tick tick) {
    const std::lock_guard lock(mutex_);
    return goals_.Begin(tick);
  }

  void GiveWay() {
    const std::lock_guard lock(mutex_);
    goals_.GiveWay();
  }

  void Publish(const WorldState& state) {
    const std::lock_guard lock(mutex_);
    const GripperGoal* const executing = goals_.executing();
    const GoalId id = executing != nullptr ? executing->id : GoalId{};
    goals_.Observe(state.tick, ros::MotionOf(*world_, gripper_, state));
    if (executing != nullptr && feedback_.wanted()) {
      if (const GripperGoal* const goal = goals_.Find(id)) {
        feedback_.Write({ToUuid(id), Describe<control_msgs_action_dds__GripperCommand_Feedback_>(*goal)});
      }
    }
    WriteStatus();
    AnswerCallers();
  }

  std::string TakeReport() {
    const std::lock_guard lock(mutex_);
    const std::uint64_t refused = refusals_.TakeDue();
    if (refused == 0) return "";
    return fmt::format("{}: refused a goal of {} m, expected 0 to {:.6g} ({} so far)", name_, refused_, largest_,
                       refused);
  }

 private:
  void SendGoal(const RosCaller& caller, const SendGoalRequest& request) {
    const std::lock_guard lock(mutex_);
    const GoalId id = ToGoalId(request.goal_id);
    SendGoalResponse response{};
    response.accepted = goals_.Accept(id, request.goal.command.position, request.goal.command.max_effort);
    if (response.accepted) {
      response.stamp = ToTime(goals_.Find(id)->stamp);
      WriteStatus();
    } else {
      refused_ = request.goal.command.position;
      refusals_.Count();
    }
    send_goal_.Respond(caller, response);
  }

  void Cancel(const RosCaller& caller, const CancelRequest& request) {
    const std::lock_guard lock(mutex_);
    const ros::Time& stamp = request.goal_info.stamp;
    std::vector<GripperGoal> canceling;
    CancelResponse response{};
    response.return_code = static_cast<std::int8_t>(goals_.Cancel(
        ToGoalId(request.goal_info.goal_id), stamp.sec * kNanosecondsPerSecond + stamp.nanosec, canceling));
    dds::WireArena arena;
    std::transform(canceling.begin(), canceling.end(), arena.Fill(response.goals_canceling, canceling.size()), InfoOf);
    WriteStatus();
    cancel_.Respond(caller, response);
  }

  void GetResult(const RosCaller& caller, const GetResultRequest& request) {
    const std::lock_guard lock(mutex_);
    callers_.emplace_back(ToGoalId(request.goal_id), caller);
    if (callers_.size() > kMostCallers) callers_.erase(callers_.begin());
    AnswerCallers();
  }

  // Those whose goal has ended or is not known.
  void AnswerCallers() {
    std::erase_if(callers_, [this](const auto& waiting) {
      const GripperGoal* const goal = goals_.Find(waiting.first);
      if (goal != nullptr && !goal->ended()) return false;
      GetResultResponse response{};
      if (goal != nullptr) {
        response.status = static_cast<std::int8_t>(goal->status);
        response.result = Describe<control_msgs_action_dds__GripperCommand_Result_>(*goal);
      }
      get_result_.Respond(waiting.second, response);
      return true;
    });
  }

  // When it is not what was written last.
  void WriteStatus() {
    std::vector<std::pair<GoalId, GoalStatus>> all;
    for (const GripperGoal& goal : goals_.goals()) all.emplace_back(goal.id, goal.status);
    if (all == written_) return;
    written_ = std::move(all);
    dds::WireArena arena;
    StatusMessage message{};
    auto* out = arena.Fill(message.status_list, goals_.goals().size());
    for (const GripperGoal& goal : goals_.goals()) *out++ = {InfoOf(goal), static_cast<std::int8_t>(goal.status)};
    status_.Write(message);
  }

  const WorldDescription* world_;
  GripperId gripper_;
  std::string name_;
  double largest_;
  std::mutex mutex_;  // guards all below
  GripperGoals goals_;
  std::vector<std::pair<GoalId, RosCaller>> callers_;  // of get_result, who wait for the end
  std::vector<std::pair<GoalId, GoalStatus>> written_;
  Refusals refusals_;
  double refused_ = 0.0;  // m, the last one
  ros::RosWriter<FeedbackMessage> feedback_;
  ros::RosWriter<StatusMessage> status_;
  // Last, because they call into the rest.
  ros::RosService<SendGoalRequest, SendGoalResponse> send_goal_;
  ros::RosService<CancelRequest, CancelResponse> cancel_;
  ros::RosService<GetResultRequest, GetResultResponse> get_result_;
};

GripperAction::GripperAction(const ros::RosNode& node, const std::string& name, const WorldDescription& world,
                             GripperId gripper)
    : server_(std::make_unique<Server>(node, name, world, gripper)) {}

GripperAction::~GripperAction() = default;

std::optional<GripperGoals::Order> GripperAction::Begin(Tick tick) {
  return server_->Begin(tick);
}

void GripperAction::GiveWay() {
  server_->GiveWay();
}

void GripperAction::Publish(const WorldState& state) {
  server_->Publish(state);
}

std::string GripperAction::TakeReport() {
  return server_->TakeReport();
}

}  // namespace troupe
