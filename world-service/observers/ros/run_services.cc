// The services that report the simulator's features, and that report and change the state of the run.
#include <iterator>

#include "world-service/observers/ros/simulation_context.h"

namespace troupe {
namespace {

TROUPE_SIMULATION_SERVICE(GetSimulatorFeatures);
TROUPE_SIMULATION_SERVICE(GetSimulationState);
TROUPE_SIMULATION_SERVICE(SetSimulationState);
TROUPE_SIMULATION_SERVICE(StepSimulation);

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

// A stopped run is a run that was paused and reset and has not moved since.
std::uint8_t StateOf(const SimulationContext& context, const ControlReply& reply) {
  if (reply.state != RunState::kOver && !context.has_world()) return kNoWorld;
  const bool stopped =
      reply.state == RunState::kPaused && reply.edition == context.stopped_edition.load() && reply.tick == 0;
  return stopped ? kStopped : ToState(reply.state);
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
  context.Ask(ControlCommand::kStatus, [call](SimulationContext& self, const ControlReply& reply) {
    dds::WireArena arena;
    GetSimulationStateResponse response{};
    response.state.state = StateOf(self, reply);
    response.result = MakeResult(ResultCode::kOk, "", arena);
    call.Respond(response);
  });
}

void StopSimulation(SimulationContext& context, const SetSimulationStateCall& call) {
  context.Ask(ControlCommand::kPause, [call](SimulationContext& self, const ControlReply& paused) {
    if (!paused.done) return call.Answer(paused);
    self.Ask(ControlCommand::kReset, [call](SimulationContext& of_reset, const ControlReply& reply) {
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
  context.Ask(ControlCommand::kStatus, [call, wanted](SimulationContext& self, const ControlReply& status) {
    if (StateOf(self, status) == wanted) return call.Answer(kAlreadyInTargetState, "it is so already");
    if (wanted == kStopped) return StopSimulation(self, call);
    if (wanted == kPaused && status.state == RunState::kPaused) {
      return call.Answer(kIncorrectTransition, "a stopped run can be played, not paused");
    }
    self.Ask(wanted == kPlaying ? ControlCommand::kPlay : ControlCommand::kPause,
             [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
  });
}

void OnStepSimulation(SimulationContext& context, const StepSimulationCall& call,
                      const StepSimulationRequest& request) {
  if (context.is_stepping()) return call.Answer(ResultCode::kOperationFailed, kIsStepping);
  context.Ask(
      ControlCommand::kStatus, [call, ticks = request.steps](SimulationContext& self, const ControlReply& status) {
        const std::uint8_t state = StateOf(self, status);
        if (state == kPlaying || (state == kStopped && status.state == RunState::kPaused)) {  // not: it is starting
          return call.Answer(ResultCode::kOperationFailed, "the run is not paused; only a paused one can step");
        }
        self.AskToStep(ticks, [call](SimulationContext&, const ControlReply& reply) { call.Answer(reply); });
      });
}

}  // namespace

void AddRunServices(ServiceSet& services) {
  services.Add("get_simulator_features", &OnGetSimulatorFeatures);
  services.Add("get_simulation_state", &OnGetSimulationState);
  services.Add("set_simulation_state", &OnSetSimulationState);
  services.Add("step_simulation", &OnStepSimulation);
}

}  // namespace troupe
