#include "world-service/ros/simulation_services.h"

#include <atomic>
#include <optional>
#include <string>
#include <utility>

#include "world-service/ros/simulation_context.h"

namespace troupe {
namespace {

using ros::RosCaller;

constexpr std::uint8_t kAlreadyInTargetState = 101;  // of SetSimulationState

// As in SimulationState.
constexpr std::uint8_t kStopped = 0;
constexpr std::uint8_t kPlaying = 1;
constexpr std::uint8_t kPaused = 2;
constexpr std::uint8_t kQuitting = 3;

// As in SimulatorFeatures: spawning, deleting, categories of entities, getting and setting their states, getting their
// infos, spawnables; reset, of time, state and what was spawned; getting and setting the state, pausing; one step,
// several, the action; loading worlds.
constexpr std::uint16_t kFeatures[] = {0, 1, 8, 10, 11, 12, 14, 20, 21, 22, 23, 24, 25, 26, 31, 32, 33, 40};

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

}  // namespace

class SimulationServices::Services : public std::enable_shared_from_this<Services> {
 public:
  explicit Services(std::shared_ptr<const SimulationContext> context) : context_(std::move(context)) {}

  void Open(const ros::RosNode& node, const std::string& name) {
    const std::string prefix = name + "/";
    const auto bind = [this](auto method) {
      return [this, method](const RosCaller& caller, const auto& request) { (this->*method)(caller, request); };
    };
    features_.Open(node, prefix + "get_simulator_features", bind(&Services::GetFeatures));
    get_state_.Open(node, prefix + "get_simulation_state", bind(&Services::OnGetState));
    set_state_.Open(node, prefix + "set_simulation_state", bind(&Services::OnSetState));
    step_.Open(node, prefix + "step_simulation", bind(&Services::OnStep));
  }

  // No service answers any more when it returns.
  void Close() {
    features_.Close();
    get_state_.Close();
    set_state_.Close();
    step_.Close();
  }

 private:
  template <typename Answered>
  void Ask(ControlCommand command, std::uint64_t ticks, Answered answered) {
    ControlRequest request;
    request.command = command;
    request.ticks = ticks;
    context_->Ask(request, weak_from_this(), std::move(answered));
  }

  void GetFeatures(const RosCaller& caller, const simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_&) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_ response{};
    std::uint16_t* feature = arena.Fill(response.features.features, std::size(kFeatures));
    for (const std::uint16_t number : kFeatures) *feature++ = number;
    arena.FillStrings(response.features.spawn_formats, {"world", "inc", "json"});
    response.features.custom_info = arena.Copy("Troupe: world " + context_->scene()->world().name);
    features_.Respond(caller, response);
  }

  // A run that was stopped is one that was reset, and pauses still.
  std::uint8_t StateOf(const ControlReply& reply) const {
    const bool stopped =
        reply.state == RunState::kPaused && reply.edition == stopped_edition_.load() && reply.tick == 0;
    return stopped ? kStopped : ToState(reply.state);
  }

  void OnGetState(const RosCaller& caller, const simulation_interfaces_srv_dds__GetSimulationState_Request_&) {
    Ask(ControlCommand::kStatus, 0, [caller](Services& self, const ControlReply& reply) {
      dds::WireArena arena;
      simulation_interfaces_srv_dds__GetSimulationState_Response_ response{};
      response.state.state = self.StateOf(reply);
      response.result = MakeResult(ResultCode::kOk, "", arena);
      self.get_state_.Respond(caller, response);
    });
  }

  void AnswerSetState(const RosCaller& caller, std::uint8_t code, const std::string& problem) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SetSimulationState_Response_ response{};
    response.result = MakeResult(code, problem, arena);
    set_state_.Respond(caller, response);
  }
  void AnswerSetState(const RosCaller& caller, const ControlReply& reply) {
    const ResultCode code = reply.done ? ResultCode::kOk : ResultCode::kOperationFailed;
    AnswerSetState(caller, static_cast<std::uint8_t>(code), reply.problem);
  }

  void OnSetState(const RosCaller& caller, const simulation_interfaces_srv_dds__SetSimulationState_Request_& request) {
    const std::uint8_t wanted = request.state.state;
    if (wanted != kPlaying && wanted != kPaused && wanted != kStopped) {
      return AnswerSetState(caller, static_cast<std::uint8_t>(ResultCode::kUnsupported),
                            "expected the state stopped (0), playing (1) or paused (2)");
    }
    Ask(ControlCommand::kStatus, 0, [caller, wanted](Services& self, const ControlReply& status) {
      if (self.StateOf(status) == wanted) {
        return self.AnswerSetState(caller, kAlreadyInTargetState, "it is so already");
      }
      if (wanted == kStopped) return self.Stop(caller);
      self.Ask(wanted == kPlaying ? ControlCommand::kPlay : ControlCommand::kPause, 0,
               [caller](Services& services, const ControlReply& reply) { services.AnswerSetState(caller, reply); });
    });
  }

  void Stop(const RosCaller& caller) {
    Ask(ControlCommand::kPause, 0, [caller](Services& self, const ControlReply& paused) {
      if (!paused.done) return self.AnswerSetState(caller, paused);
      self.Ask(ControlCommand::kReset, 0, [caller](Services& services, const ControlReply& reply) {
        if (reply.done) services.stopped_edition_ = reply.edition;
        services.AnswerSetState(caller, reply);
      });
    });
  }

  void OnStep(const RosCaller& caller, const simulation_interfaces_srv_dds__StepSimulation_Request_& request) {
    Ask(ControlCommand::kStep, request.steps, [caller](Services& self, const ControlReply& reply) {
      dds::WireArena arena;
      simulation_interfaces_srv_dds__StepSimulation_Response_ response{};
      const ResultCode failure =
          reply.state == RunState::kPlaying ? ResultCode::kIncorrectState : ResultCode::kOperationFailed;
      response.result = MakeResult(reply.done ? ResultCode::kOk : failure, reply.problem, arena);
      self.step_.Respond(caller, response);
    });
  }

  const std::shared_ptr<const SimulationContext> context_;
  std::atomic<std::optional<Edition>> stopped_edition_ = {};
  ServiceSlot<simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_,
              simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_>
      features_;
  ServiceSlot<simulation_interfaces_srv_dds__GetSimulationState_Request_,
              simulation_interfaces_srv_dds__GetSimulationState_Response_>
      get_state_;
  ServiceSlot<simulation_interfaces_srv_dds__SetSimulationState_Request_,
              simulation_interfaces_srv_dds__SetSimulationState_Response_>
      set_state_;
  ServiceSlot<simulation_interfaces_srv_dds__StepSimulation_Request_,
              simulation_interfaces_srv_dds__StepSimulation_Response_>
      step_;
};

SimulationServices::SimulationServices(const ros::RosNode& node, const std::string& name,
                                       const ros::RosOptions& options, const std::shared_ptr<const Scene>& scene,
                                       WorldControl& control)
    : context_(std::make_shared<SimulationContext>(scene, control)),
      services_(std::make_shared<Services>(context_)),
      entities_(node, name, options.distribution, context_),
      step_action_(node, name + "/simulate_steps", context_) {
  services_->Open(node, name);
}

void SimulationServices::ChangeWorld(const std::shared_ptr<const Scene>& scene) {
  context_->ChangeWorld(scene);
}

SimulationServices::~SimulationServices() {
  services_->Close();
}

}  // namespace troupe
