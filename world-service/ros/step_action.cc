#include "world-service/ros/step_action.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "common/ros_dds/action_server.h"
#include "common/ros_dds/simulation_types.h"
#include "world-service/ros/simulation_context.h"

namespace troupe {
namespace {

using ros::GoalId;
using ros::GoalStatus;
using ros::RosCaller;

struct SimulateStepsTypes {
  using SendGoalRequest = simulation_interfaces_action_dds__SimulateSteps_SendGoal_Request_;
  using SendGoalResponse = simulation_interfaces_action_dds__SimulateSteps_SendGoal_Response_;
  using GetResultRequest = simulation_interfaces_action_dds__SimulateSteps_GetResult_Request_;
  using GetResultResponse = simulation_interfaces_action_dds__SimulateSteps_GetResult_Response_;
  using FeedbackMessage = simulation_interfaces_action_dds__SimulateSteps_FeedbackMessage_;
};

struct StepGoal : ros::ActionGoal {
  std::uint64_t steps = 0;
  std::uint64_t completed = 0;
  ResultCode code = ResultCode::kOperationFailed;
  std::string problem;
};

}  // namespace

// The control calls Begin, Finish and Publish with a lock of its own. So it is never asked with the lock of this.
class StepAction::Server : public std::enable_shared_from_this<Server> {
 public:
  explicit Server(std::shared_ptr<const SimulationContext> context) : context_(std::move(context)) {}

  void Open(const ros::RosNode& node, const std::string& name) {
    auto made = std::make_unique<ActionServer>(
        node, name,
        ActionServer::Handlers{
            .send_goal = [this](const RosCaller& caller, const auto& request) { SendGoal(caller, request); },
            .cancel = [this](const RosCaller& caller, const GoalId& id,
                             std::int64_t stamp) { Cancel(caller, id, stamp); },
            .get_result = [this](const RosCaller& caller, const GoalId& id) { GetResult(caller, id); }});
    ActionServer& action = *made;
    {
      const std::lock_guard lock(mutex_);
      action_ = std::move(made);
    }
    action.Start();
  }

  // No handler runs any more when it returns.
  void Close() {
    std::unique_ptr<ActionServer> action;
    {
      const std::lock_guard lock(mutex_);
      action.swap(action_);
    }
    // Without the lock, because a handler may be waiting for it.
  }

  void Publish(const FrameMessage& frame) {
    {
      const std::lock_guard lock(mutex_);
      StepGoal* const goal = FindOpen();
      if (goal == nullptr) return;
      const bool is_step = frame.edition == edition_ && frame.state.tick == tick_ + 1 && goal->completed < goal->steps;
      tick_ = frame.state.tick;
      edition_ = frame.edition;
      if (is_step) {
        ++goal->completed;
        if (action_ && action_->feedback_wanted()) {
          action_->WriteFeedback(goal->id, simulation_interfaces_action_dds__SimulateSteps_Feedback_{
                                               goal->completed, goal->steps - goal->completed});
        }
      }
      if (goal->status != GoalStatus::kCanceling || frame.paused) return;
    }
    Ask(ControlCommand::kPause, 0, [](Server&, const ControlReply&) {});  // it was cancelled before it had begun
  }

 private:
  using ActionServer = ros::ActionServer<SimulateStepsTypes>;

  template <typename Answered>
  void Ask(ControlCommand command, std::uint64_t ticks, Answered answered) {
    ControlRequest request;
    request.command = command;
    request.ticks = ticks;
    context_->Ask(request, weak_from_this(), std::move(answered));
  }

  void SendGoal(const RosCaller& caller, const SimulateStepsTypes::SendGoalRequest& request) {
    StepGoal goal;
    goal.id = ros::ToGoalId(request.goal_id);
    goal.steps = request.goal.steps;
    Ask(ControlCommand::kStatus, 0,
        [caller, goal](Server& self, const ControlReply& status) { self.Begin(caller, goal, status); });
  }

  void Begin(const RosCaller& caller, StepGoal goal, const ControlReply& status) {
    {
      const std::lock_guard lock(mutex_);
      goal.stamp = static_cast<std::int64_t>(status.tick) * context_->scene()->world().interval_ns;
      goal.status = GoalStatus::kExecuting;
      const bool accepted = FindOpen() == nullptr && goals_.Add(goal);
      if (action_) action_->AnswerGoal(caller, accepted, goal.stamp);
      if (!accepted) return;
      tick_ = status.tick;
      edition_ = status.edition;
      // Also while somebody else's steps are made.
      if (status.state == RunState::kPlaying) {
        return End(*goals_.Find(goal.id), GoalStatus::kAborted, "the run is playing; only a paused one can step");
      }
      Tell();
    }
    Ask(ControlCommand::kStep, goal.steps,
        [id = goal.id](Server& self, const ControlReply& reply) { self.Finish(id, reply); });
  }

  void Finish(const GoalId& id, const ControlReply& reply) {
    const std::lock_guard lock(mutex_);
    StepGoal& goal = *goals_.Find(id);
    if (reply.done) {
      goal.completed = goal.steps;
      goal.code = ResultCode::kOk;
      return End(goal, GoalStatus::kSucceeded, "");
    }
    End(goal, goal.status == GoalStatus::kCanceling ? GoalStatus::kCanceled : GoalStatus::kAborted, reply.problem);
  }

  void Cancel(const RosCaller& caller, const GoalId& id, std::int64_t stamp) {
    std::vector<StepGoal> canceling;
    {
      const std::lock_guard lock(mutex_);
      const ros::CancelAnswer answer = goals_.Cancel(id, stamp, canceling);
      if (action_) action_->AnswerCancel(caller, answer, canceling);
      Tell();
    }
    if (canceling.empty()) return;
    // It may have ended by the time this is heard; then what goes on is somebody else's.
    Ask(ControlCommand::kStatus, 0, [](Server& self, const ControlReply&) {
      if (self.IsCanceling()) self.Ask(ControlCommand::kPause, 0, [](Server&, const ControlReply&) {});
    });
  }

  void GetResult(const RosCaller& caller, const GoalId& id) {
    const std::lock_guard lock(mutex_);
    if (action_) action_->AwaitResult(caller, id);
    Tell();
  }

  bool IsCanceling() {
    const std::lock_guard lock(mutex_);
    const StepGoal* const goal = FindOpen();
    return goal != nullptr && goal->status == GoalStatus::kCanceling;
  }

  // There is one at most.
  StepGoal* FindOpen() {
    std::vector<StepGoal>& all = goals_.all();
    const auto found = std::find_if(all.begin(), all.end(), [](const StepGoal& goal) { return !goal.ended(); });
    return found == all.end() ? nullptr : &*found;
  }

  void End(StepGoal& goal, GoalStatus status, const std::string& problem) {
    goal.status = status;
    goal.problem = problem;
    goals_.Forget();
    Tell();
  }

  // Everybody what is new.
  void Tell() {
    if (!action_) return;
    action_->WriteStatus(goals_.all());
    action_->AnswerResults(goals_, [](const StepGoal& goal, dds::WireArena& arena) {
      return simulation_interfaces_action_dds__SimulateSteps_Result_{MakeResult(goal.code, goal.problem, arena)};
    });
  }

  const std::shared_ptr<const SimulationContext> context_;
  std::mutex mutex_;  // guards all below
  ros::ActionGoals<StepGoal> goals_;
  Tick tick_ = 0;  // of the frame seen last
  Edition edition_ = 0;
  std::unique_ptr<ActionServer> action_;  // while it is open
};

StepAction::StepAction(const ros::RosNode& node, const std::string& name,
                       std::shared_ptr<const SimulationContext> context)
    : server_(std::make_shared<Server>(std::move(context))) {
  server_->Open(node, name);
}

StepAction::~StepAction() {
  server_->Close();
}

void StepAction::Publish(const FrameMessage& frame) {
  server_->Publish(frame);
}

}  // namespace troupe
