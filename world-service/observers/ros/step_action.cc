#include "world-service/observers/ros/step_action.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "ros/connection/action_server.h"
#include "ros/connection/simulation_types.h"
#include "world-service/observers/ros/simulation_context.h"

namespace troupe {
namespace {

using ros::GoalId;
using ros::GoalStatus;
using ros::RosCaller;

TROUPE_ACTION_TYPES(SimulateStepsTypes, simulation_interfaces_action_dds__SimulateSteps);

struct StepGoal : ros::ActionGoal {
  std::uint64_t steps = 0;
  std::uint64_t completed = 0;
  ResultCode code = ResultCode::kOperationFailed;
  std::string problem;
};

}  // namespace

// The control calls Begin, Finish and Publish with its own mutex locked. So the server sends it no request while mutex_
// is locked.
class StepAction::Server : public std::enable_shared_from_this<Server> {
 public:
  explicit Server(std::shared_ptr<SimulationContext> context) : context_(std::move(context)) {}

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

  // No handler runs after it returns.
  void Close() {
    std::unique_ptr<ActionServer> action;
    {
      const std::lock_guard lock(mutex_);
      action.swap(action_);
    }
    // The action ends without the lock: a running handler may be waiting for the lock.
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
    Ask(ControlCommand::kPause, [](Server&, const ControlReply&) {});  // the goal was cancelled before its steps began
  }

 private:
  using ActionServer = ros::ActionServer<SimulateStepsTypes>;

  // An answer that is dropped after the end of the action.
  template <typename Answered>
  auto UntilTheEnd(Answered answered) {
    return [weak = weak_from_this(), answered](SimulationContext&, const ControlReply& reply) {
      if (const auto self = weak.lock()) answered(*self, reply);
    };
  }
  template <typename Answered>
  void Ask(ControlCommand command, Answered answered) {
    context_->Ask(command, UntilTheEnd(answered));
  }

  void SendGoal(const RosCaller& caller, const SimulateStepsTypes::SendGoalRequest& request) {
    StepGoal goal;
    goal.id = ros::ToGoalId(request.goal_id);
    goal.steps = request.goal.steps;
    Ask(ControlCommand::kStatus,
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
      // A run that makes the steps of another request is playing too.
      if (status.state == RunState::kPlaying) {
        return End(*goals_.Find(goal.id), GoalStatus::kAborted, "the run is playing; only a paused one can step");
      }
      PublishChanges();
    }
    context_->AskToStep(
        goal.steps, UntilTheEnd([id = goal.id](Server& self, const ControlReply& reply) { self.Finish(id, reply); }));
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
    ros::CancelResult<StepGoal> cancelled;
    {
      const std::lock_guard lock(mutex_);
      cancelled = goals_.Cancel(id, stamp);
      if (action_) action_->AnswerCancel(caller, cancelled);
      PublishChanges();
    }
    if (cancelled.canceling.empty()) return;
    // The goal may have ended before the control answers; then a pause would stop the steps of another request.
    Ask(ControlCommand::kStatus, [](Server& self, const ControlReply&) {
      if (self.IsCanceling()) self.Ask(ControlCommand::kPause, [](Server&, const ControlReply&) {});
    });
  }

  void GetResult(const RosCaller& caller, const GoalId& id) {
    const std::lock_guard lock(mutex_);
    if (action_) action_->AwaitResult(caller, id);
    PublishChanges();
  }

  bool IsCanceling() {
    const std::lock_guard lock(mutex_);
    const StepGoal* const goal = FindOpen();
    return goal != nullptr && goal->status == GoalStatus::kCanceling;
  }

  // Null if no goal is open. At most one is.
  StepGoal* FindOpen() {
    std::vector<StepGoal>& all = goals_.all();
    const auto found = std::find_if(all.begin(), all.end(), [](const StepGoal& goal) { return !goal.ended(); });
    return found == all.end() ? nullptr : &*found;
  }

  void End(StepGoal& goal, GoalStatus status, const std::string& problem) {
    goal.status = status;
    goal.problem = problem;
    goals_.RemoveOldEnded();
    PublishChanges();
  }

  // Sends the changed status, and the results of ended goals.
  void PublishChanges() {
    if (!action_) return;
    action_->WriteStatus(goals_.all());
    action_->AnswerResults(goals_, [](const StepGoal& goal, dds::WireArena& arena) {
      return simulation_interfaces_action_dds__SimulateSteps_Result_{MakeResult(goal.code, goal.problem, arena)};
    });
  }

  const std::shared_ptr<SimulationContext> context_;
  std::mutex mutex_;  // guards the members below
  ros::ActionGoals<StepGoal> goals_;
  Tick tick_ = 0;  // of the last frame
  Edition edition_ = 0;
  std::unique_ptr<ActionServer> action_;  // while it is open
};

StepAction::StepAction(const ros::RosNode& node, const std::string& name, std::shared_ptr<SimulationContext> context)
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
