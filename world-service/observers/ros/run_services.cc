// The services that report the simulator's features, and that report and change the state of the run.
#include "world-service/observers/ros/run_services.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "ros/connection/action_server.h"
#include "ros/connection/topic_types.h"
#include "world-service/observers/ros/simulation_context.h"

namespace troupe {
namespace {

TROUPE_SIMULATION_SERVICE(GetSimulatorFeatures);
TROUPE_SIMULATION_SERVICE(GetSimulationState);
TROUPE_SIMULATION_SERVICE(SetSimulationState);
TROUPE_SIMULATION_SERVICE(StepSimulation);

// Results of SetSimulationState.
constexpr std::uint8_t kAlreadyInTargetState = 101;
constexpr std::uint8_t kIncorrectTransition = 103;

// As in SimulationState.
constexpr std::uint8_t kStopped = 0;
constexpr std::uint8_t kPlaying = 1;
constexpr std::uint8_t kPaused = 2;
constexpr std::uint8_t kQuitting = 3;
constexpr std::uint8_t kNoWorld = 4;

// As in SimulatorFeatures: spawning, deleting, named poses, tags and bounds of entities (box and convex hull), their
// categories, spawning from a text, getting and setting states and infos, spawnables; reset of time, of states and of
// spawned entities; getting and setting the state, pausing; a step, several steps, the action; loading worlds, also
// from a text, unloading, the current and available worlds; spawning several entities.
constexpr std::uint16_t kFeatures[] = {0,  1,  2,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 20,
                                       21, 22, 23, 24, 25, 26, 31, 32, 33, 40, 41, 43, 44, 45, 50};

std::uint8_t ToState(RunState state) {
  switch (state) {
    case RunState::kStarting:
      return kStopped;
    case RunState::kPlaying:
      return kPlaying;
    case RunState::kPaused:
      return kPaused;
    case RunState::kOver:
      return kQuitting;
  }
  return kStopped;
}

// A stopped run is a run that was paused and reset and has not moved since.
bool IsStopped(const SimulationContext& context, const ControlReply& reply) {
  return reply.state == RunState::kPaused && reply.edition == context.stopped_edition.load() && reply.tick == 0;
}

std::uint8_t StateOf(const SimulationContext& context, const ControlReply& reply) {
  if (reply.state != RunState::kOver && !context.has_world()) return kNoWorld;
  return IsStopped(context, reply) ? kStopped : ToState(reply.state);
}

// The reason for which a run in this state cannot step; null: it can. One that makes the steps of another request
// plays.
const char* ProblemOfSteps(const SimulationContext& context, const ControlReply& status) {
  if (status.state == RunState::kPlaying) return "the run is playing; only a paused one can step";
  return IsStopped(context, status) ? "the run is stopped; it can be played, and only a paused one can step" : nullptr;
}

void OnGetSimulatorFeatures(SimulationContext& context, const GetSimulatorFeaturesCall& call,
                            const GetSimulatorFeaturesRequest&) {
  dds::WireArena arena;
  GetSimulatorFeaturesResponse response{};
  std::uint16_t* feature = arena.Fill(response.features.features, std::size(kFeatures));
  for (const std::uint16_t number : kFeatures) *feature++ = number;
  arena.FillStrings(response.features.spawn_formats, {"world", "inc", "json"});
  response.features.custom_info = arena.Copy("Troupe: world " + context.scene()->world().name);
  call.Respond(response);
}

void OnGetSimulationState(SimulationContext& context, const GetSimulationStateCall& call,
                          const GetSimulationStateRequest&) {
  context.Ask(control::GetStatus(), [call](SimulationContext& self, const ControlReply& reply) {
    dds::WireArena arena;
    GetSimulationStateResponse response{};
    response.state.state = StateOf(self, reply);
    response.result = MakeResult(ResultCode::kOk, "", arena);
    call.Respond(response);
  });
}

void StopSimulation(SimulationContext& context, const SetSimulationStateCall& call) {
  context.Ask(control::Pause(), [call](SimulationContext& self, const ControlReply& paused) {
    if (!paused.done) return call.Answer(paused);
    self.Ask(control::Reset(), [call](SimulationContext& of_reset, const ControlReply& reply) {
      if (reply.done) of_reset.stopped_edition = reply.edition;
      call.Answer(reply);
    });
  });
}

void OnSetSimulationState(SimulationContext& context, const SetSimulationStateCall& call,
                          const SetSimulationStateRequest& request) {
  const std::uint8_t wanted = request.state.state;
  if (wanted != kPlaying && wanted != kPaused && wanted != kStopped) {
    return call.Answer(ResultCode::kUnsupported, "expected the state stopped (0), playing (1) or paused (2)");
  }
  context.Ask(control::GetStatus(), [call, wanted](SimulationContext& self, const ControlReply& status) {
    if (StateOf(self, status) == wanted) return call.Answer(kAlreadyInTargetState, "it is so already");
    if (wanted == kStopped) return StopSimulation(self, call);
    if (wanted == kPaused && status.state == RunState::kPaused) {
      return call.Answer(kIncorrectTransition, "a stopped run can be played, not paused");
    }
    self.Ask(wanted == kPlaying ? control::Request(control::Play()) : control::Pause(),
             [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
  });
}

void OnStepSimulation(SimulationContext& context, const StepSimulationCall& call,
                      const StepSimulationRequest& request) {
  if (context.is_stepping()) return call.Answer(ResultCode::kOperationFailed, kIsStepping);
  context.Ask(control::GetStatus(), [call, ticks = request.steps](SimulationContext& self, const ControlReply& status) {
    if (const char* const problem = ProblemOfSteps(self, status)) {
      return call.Answer(ResultCode::kOperationFailed, problem);
    }
    self.AskToStep(ticks, [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
  });
}

using ros::GoalId;
using ros::GoalStatus;
using ros::RosCaller;

TROUPE_ACTION_TYPES(SimulateStepsTypes, simulation_interfaces_action_dds__SimulateSteps);

// The values of a goal that is not known.
struct StepGoal : ros::ActionGoal {
  std::uint64_t steps = 0;
  std::uint64_t completed = 0;
  ResultCode code = ResultCode::kOperationFailed;
  std::string problem = "no such goal; one of a world service that has died is aborted, while its steps go on";
};

}  // namespace

void AddRunServices(ServiceSet& services) {
  services.Add("get_simulator_features", &OnGetSimulatorFeatures);
  services.Add("get_simulation_state", &OnGetSimulationState);
  services.Add("set_simulation_state", &OnSetSimulationState);
  services.Add("step_simulation", &OnStepSimulation);
}

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
    Ask(control::Pause(), [](Server&, const ControlReply&) {});  // the goal was cancelled before its steps began
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
  void Ask(const control::Request& request, Answered answered) {
    context_->Ask(request, UntilTheEnd(answered));
  }

  void SendGoal(const RosCaller& caller, const SimulateStepsTypes::SendGoalRequest& request) {
    StepGoal goal;
    goal.id = ros::ToGoalId(request.goal_id);
    goal.steps = request.goal.steps;
    if (caller.is_repeated) {  // the service before has begun its steps perhaps
      const std::lock_guard lock(mutex_);
      if (action_) action_->AnswerGoal(caller, false, 0);
      return;
    }
    Ask(control::GetStatus(),
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
      if (const char* const problem = ProblemOfSteps(*context_, status)) {
        return End(*goals_.Find(goal.id), GoalStatus::kAborted, problem);
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
    Ask(control::GetStatus(), [](Server& self, const ControlReply&) {
      if (self.IsCanceling()) self.Ask(control::Pause(), [](Server&, const ControlReply&) {});
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
