// ActionServer<Types>: the topics and services of an action, as rcl lays them out (send_goal, cancel_goal, get_result,
// feedback, status). Its owner keeps the goals (ros/messages/action_goals.h), and its types are those of
// TROUPE_ACTION_TYPES. There is no action in DDS itself: clients find one by these five names alone.
//
// Requests arrive on threads of the connection, through the functions of Handlers, which must only note them: the state
// of the world is read and changed between ticks by the agent's thread. REQUIRES: all other calls are made one at a
// time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/messages/action_goals.h"
#include "transport/dds/binding/wire.h"

namespace troupe::ros {

inline GoalId ToGoalId(const unique_identifier_msgs_msg_dds__UUID_& uuid) {
  GoalId id;
  std::copy(std::begin(uuid.uuid), std::end(uuid.uuid), id.begin());
  return id;
}
inline unique_identifier_msgs_msg_dds__UUID_ ToUuid(const GoalId& id) {
  unique_identifier_msgs_msg_dds__UUID_ uuid{};
  std::copy(id.begin(), id.end(), std::begin(uuid.uuid));
  return uuid;
}
inline Time ActionTime(std::int64_t ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {static_cast<std::int32_t>(ns / kSecond), static_cast<std::uint32_t>(ns % kSecond)};
}

// The types of an action, by the name that they begin with: "control_msgs_action_dds__GripperCommand".
#define TROUPE_ACTION_TYPES(Types, action)                  \
  struct Types {                                            \
    using SendGoalRequest = action##_SendGoal_Request_;     \
    using SendGoalResponse = action##_SendGoal_Response_;   \
    using GetResultRequest = action##_GetResult_Request_;   \
    using GetResultResponse = action##_GetResult_Response_; \
    using FeedbackMessage = action##_FeedbackMessage_;      \
  }

template <typename Types>
class ActionServer {
 public:
  using SendGoalRequest = typename Types::SendGoalRequest;
  using SendGoalResponse = typename Types::SendGoalResponse;
  using GetResultRequest = typename Types::GetResultRequest;
  using GetResultResponse = typename Types::GetResultResponse;
  using FeedbackMessage = typename Types::FeedbackMessage;
  using CancelRequest = action_msgs_srv_dds__CancelGoal_Request_;
  using CancelResponse = action_msgs_srv_dds__CancelGoal_Response_;

  struct Handlers {
    std::function<void(const RosCaller&, const SendGoalRequest&)> send_goal;  // answered by AnswerGoal
    // Answered by AnswerCancel. `stamp` in ns, as in ActionGoals::Cancel.
    std::function<void(const RosCaller&, const GoalId&, std::int64_t stamp)> cancel;
    std::function<void(const RosCaller&, const GoalId&)> get_result;  // leads to AwaitResult
  };

  // `name`: of the action.
  ActionServer(const RosNode& node, const std::string& name, Handlers handlers)
      : handlers_(std::move(handlers)),
        feedback_(node, name + "/_action/feedback", Stream(kFeedbackDepth)),
        status_(node, name + "/_action/status", Latched()),
        send_goal_(node, name + "/_action/send_goal", handlers_.send_goal, Service(), Serving::kWhenStarted),
        cancel_(
            node, name + "/_action/cancel_goal",
            [this](const RosCaller& caller, const CancelRequest& request) {
              const Time& stamp = request.goal_info.stamp;
              handlers_.cancel(caller, ToGoalId(request.goal_info.goal_id),
                               stamp.sec * std::int64_t{1'000'000'000} + stamp.nanosec);
            },
            Service(), Serving::kWhenStarted),
        get_result_(
            node, name + "/_action/get_result",
            [this](const RosCaller& caller, const GetResultRequest& request) {
              handlers_.get_result(caller, ToGoalId(request.goal_id));
            },
            Service(), Serving::kWhenStarted) {}
  // Call once, as soon as the handlers may run. Handles the requests that have arrived before.
  void Start() {
    send_goal_.Start();
    cancel_.Start();
    get_result_.Start();
  }

  void AnswerGoal(const RosCaller& caller, bool accepted, std::int64_t stamp) {
    SendGoalResponse response{};
    response.accepted = accepted;
    response.stamp = ActionTime(stamp);
    send_goal_.Respond(caller, response);
  }

  template <typename Goal>
  void AnswerCancel(const RosCaller& caller, const CancelResult<Goal>& result) {
    const std::vector<Goal>& canceling = result.canceling;
    CancelResponse response{};
    response.return_code = static_cast<std::int8_t>(result.answer);
    dds::WireArena arena;
    std::transform(canceling.begin(), canceling.end(), arena.Fill(response.goals_canceling, canceling.size()), InfoOf);
    cancel_.Respond(caller, response);
  }

  bool feedback_wanted() const { return feedback_.wanted(); }
  template <typename Feedback>
  void WriteFeedback(const GoalId& id, const Feedback& feedback) {
    feedback_.Write({ToUuid(id), feedback});
  }

  // Writes nothing if no state has changed since the last call.
  template <typename Goal>
  void WriteStatus(const std::vector<Goal>& goals) {
    std::vector<std::pair<GoalId, GoalStatus>> all;
    for (const Goal& goal : goals) all.emplace_back(goal.id, goal.status);
    if (all == written_) return;
    written_ = std::move(all);
    dds::WireArena arena;
    action_msgs_msg_dds__GoalStatusArray_ message{};
    auto* out = arena.Fill(message.status_list, goals.size());
    for (const Goal& goal : goals) *out++ = {InfoOf(goal), static_cast<std::int8_t>(goal.status)};
    status_.Write(message);
  }

  // A later AnswerResults sends the goal's result to the caller.
  void AwaitResult(const RosCaller& caller, const GoalId& id) {
    callers_.emplace_back(id, caller);
    if (callers_.size() > kMaxCallers) callers_.erase(callers_.begin());
  }
  // Answers the callers whose goal has ended or is not known; that of a process before has been aborted with it.
  // `describe(goal, arena)` makes the result of a goal.
  template <typename Goal, typename Describe>
  void AnswerResults(const ActionGoals<Goal>& goals, const Describe& describe) {
    std::erase_if(callers_, [&](const auto& waiting) {
      const Goal* const goal = goals.Find(waiting.first);
      if (goal != nullptr && !goal->ended()) return false;
      dds::WireArena arena;
      GetResultResponse response{};
      response.result = describe(goal != nullptr ? *goal : Goal{}, arena);
      const GoalStatus of_unknown = waiting.second.is_repeated ? GoalStatus::kAborted : GoalStatus::kUnknown;
      response.status = static_cast<std::int8_t>(goal != nullptr ? goal->status : of_unknown);
      get_result_.Respond(waiting.second, response);
      return true;
    });
  }

 private:
  static constexpr std::int32_t kFeedbackDepth = 10;
  static constexpr std::size_t kMaxCallers = 100;

  static action_msgs_msg_dds__GoalInfo_ InfoOf(const ActionGoal& goal) {
    return {ToUuid(goal.id), ActionTime(goal.stamp)};
  }

  const Handlers handlers_;
  std::vector<std::pair<GoalId, RosCaller>> callers_;  // of get_result, waiting for the end of a goal
  std::vector<std::pair<GoalId, GoalStatus>> written_;
  RosWriter<FeedbackMessage> feedback_;
  RosWriter<action_msgs_msg_dds__GoalStatusArray_> status_;
  // Last, because they call handlers_.
  RosService<SendGoalRequest, SendGoalResponse> send_goal_;
  RosService<CancelRequest, CancelResponse> cancel_;
  RosService<GetResultRequest, GetResultResponse> get_result_;
};

}  // namespace troupe::ros
