#include "world-service/observers/ros/run_services.h"

#include <iterator>

namespace troupe {
namespace {

using ros::RosCaller;

// Of SetSimulationState.
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

}  // namespace

void RunServices::Open(const ros::RosNode& node, const std::string& prefix) {
  get_features_.Open(node, prefix + "get_simulator_features", Bind(&RunServices::OnGetFeatures));
  get_state_.Open(node, prefix + "get_simulation_state", Bind(&RunServices::OnGetState));
  set_state_.Open(node, prefix + "set_simulation_state", Bind(&RunServices::OnSetState));
  step_.Open(node, prefix + "step_simulation", Bind(&RunServices::OnStep));
}

void RunServices::Close() {
  get_features_.Close();
  get_state_.Close();
  set_state_.Close();
  step_.Close();
}

void RunServices::OnGetFeatures(const RosCaller& caller,
                                const simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_&) {
  dds::WireArena arena;
  simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_ response{};
  std::uint16_t* feature = arena.Fill(response.features.features, std::size(kFeatures));
  for (const std::uint16_t number : kFeatures) *feature++ = number;
  arena.FillStrings(response.features.spawn_formats, {"world", "inc", "json"});
  response.features.custom_info = arena.Copy("Troupe: world " + context().scene()->world().name);
  get_features_.Respond(caller, response);
}

// A stopped run is a run that was paused and reset and has not moved since.
std::uint8_t RunServices::StateOf(const ControlReply& reply) const {
  if (reply.state != RunState::kOver && !context().has_world()) return kNoWorld;
  const bool stopped = reply.state == RunState::kPaused && reply.edition == stopped_edition_.load() && reply.tick == 0;
  return stopped ? kStopped : ToState(reply.state);
}

void RunServices::OnGetState(const RosCaller& caller,
                             const simulation_interfaces_srv_dds__GetSimulationState_Request_&) {
  Ask(ControlCommand::kStatus, [caller](RunServices& self, const ControlReply& reply) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetSimulationState_Response_ response{};
    response.state.state = self.StateOf(reply);
    response.result = MakeResult(ResultCode::kOk, "", arena);
    self.get_state_.Respond(caller, response);
  });
}

void RunServices::AnswerSetState(const RosCaller& caller, std::uint8_t code, const std::string& problem) {
  dds::WireArena arena;
  simulation_interfaces_srv_dds__SetSimulationState_Response_ response{};
  response.result = MakeResult(code, problem, arena);
  set_state_.Respond(caller, response);
}

void RunServices::AnswerSetState(const RosCaller& caller, const ControlReply& reply) {
  AnswerSetState(caller, static_cast<std::uint8_t>(CodeOf(reply)), reply.problem);
}

void RunServices::OnSetState(const RosCaller& caller,
                             const simulation_interfaces_srv_dds__SetSimulationState_Request_& request) {
  const std::uint8_t wanted = request.state.state;
  if (wanted != kPlaying && wanted != kPaused && wanted != kStopped) {
    return AnswerSetState(caller, static_cast<std::uint8_t>(ResultCode::kUnsupported),
                          "expected the state stopped (0), playing (1) or paused (2)");
  }
  Ask(ControlCommand::kStatus, [caller, wanted](RunServices& self, const ControlReply& status) {
    if (self.StateOf(status) == wanted) {
      return self.AnswerSetState(caller, kAlreadyInTargetState, "it is so already");
    }
    if (wanted == kStopped) return self.Stop(caller);
    if (wanted == kPaused && status.state == RunState::kPaused) {
      return self.AnswerSetState(caller, kIncorrectTransition, "a stopped run can be played, not paused");
    }
    self.Ask(wanted == kPlaying ? ControlCommand::kPlay : ControlCommand::kPause,
             [caller](RunServices& services, const ControlReply& reply) { services.AnswerSetState(caller, reply); });
  });
}

void RunServices::Stop(const RosCaller& caller) {
  Ask(ControlCommand::kPause, [caller](RunServices& self, const ControlReply& paused) {
    if (!paused.done) return self.AnswerSetState(caller, paused);
    self.Ask(ControlCommand::kReset, [caller](RunServices& services, const ControlReply& reply) {
      if (reply.done) services.stopped_edition_ = reply.edition;
      services.AnswerSetState(caller, reply);
    });
  });
}

void RunServices::OnStep(const RosCaller& caller,
                         const simulation_interfaces_srv_dds__StepSimulation_Request_& request) {
  ControlRequest step;
  step.command = ControlCommand::kStep;
  step.ticks = request.steps;
  Ask(step, [caller](RunServices& self, const ControlReply& reply) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__StepSimulation_Response_ response{};
    response.result = MakeResult(reply, arena);
    self.step_.Respond(caller, response);
  });
}

}  // namespace troupe
